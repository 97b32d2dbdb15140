// Motion of a trajectory: poses of frames between the recorded times.

import { LINE, channels } from './data.js';

export class Track {
  constructor(binary, track, steps, frames) {
    const { count } = track;
    this.label = track.label;
    [this.times] = channels(binary, track.times, 1, count, LINE).map((times) => times.map((n) => n * steps.time));
    this.poses = channels(binary, track.poses, 7 * frames, count, LINE);
    this.poses.forEach((values, channel) => {
      const step = channel % 7 < 3 ? steps.position : steps.rotation;
      for (let i = 0; i < count; i++) values[i] *= step;
    });
    this.deformables = (track.deformables ?? []).map(({ vertices, values }) => {
      const all = channels(binary, values, 3 * vertices, count, LINE);
      return all.map((numbers) => Float32Array.from(numbers, (n) => n * steps.position));
    });
    this.curves = track.curves.map(({ name, unit, interval, values }) => {
      const [numbers] = channels(binary, values, 1, count, LINE);
      const value = (n) => (n > 0 ? interval.low + interval.step * (n - 1) : NaN);
      return { name, unit, values: numbers.map(value) };
    });
  }

  get start() {
    return this.times[0];
  }

  get end() {
    return this.times[this.times.length - 1];
  }

  /** Returns the index of the last record at or before a time. */
  index(time) {
    let low = 0;
    let high = this.times.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle;
    }
    return low;
  }

  /** Returns the records before and after a time, and the part of the way between them. */
  place(time) {
    const i = this.index(time);
    const j = Math.min(i + 1, this.times.length - 1);
    const span = this.times[j] - this.times[i];
    return [i, j, span > 0 ? Math.min(Math.max((time - this.times[i]) / span, 0), 1) : 0];
  }

  /** Sets the positions and orientations of objects, one for each frame, at a time. */
  pose(time, objects) {
    const [i, j, f] = this.place(time);
    objects.forEach((object, frame) => {
      const at = (part) => {
        const values = this.poses[7 * frame + part];
        return values[i] + f * (values[j] - values[i]);
      };
      object.position.set(at(0), at(1), at(2));
      object.quaternion.set(at(4), at(5), at(6), at(3)).normalize();
    });
  }

  /** Returns the coordinates of the vertices of a deformable shape at a time. */
  vertices(index, time) {
    const [i, j, f] = this.place(time);
    return Float32Array.from(this.deformables[index], (values) => values[i] + f * (values[j] - values[i]));
  }

  /** Returns true if a frame has one pose, that of another track's start. */
  isFixed(frame, other) {
    return this.poses
      .slice(7 * frame, 7 * frame + 7)
      .every((values, part) => values.every((value) => value === other.poses[7 * frame + part][0]));
  }
}
