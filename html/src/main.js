// Player of a page.

import { Raycaster, Vector2 } from 'three';
import { Cameras } from './cameras.js';
import { Track } from './motion.js';
import { Plots } from './plots.js';
import { Stage } from './stage.js';

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const LAYOUTS = ['Ghosts', 'Side by side', 'One'];
export const element = (id) => document.getElementById(id);

export class Player {
  static async create(data) {
    const player = new this();
    const { look, bodies, title, notes } = data.description;
    player.data = data.description;
    player.tracks = player.createTracks(data);
    player.start = Math.min(...player.tracks.map((track) => track.start));
    player.end = Math.max(...player.tracks.map((track) => track.end));
    player.canvas = element('canvas');
    player.stage = await Stage.create(player.canvas, data, player.tracks);
    player.cameras = new Cameras(player.canvas, look, player.stage.frames[0], () => (player.isDirty = true));
    player.bodies = bodies;
    player.notes = notes.slice().sort((a, b) => a[0] - b[0]);
    player.speed = 1;
    document.title = element('title').textContent = title || 'Simulation';
    player.spacing = data.description.spacing ?? data.description.extent;
    player.count = player.data.live ? 1 : player.tracks.length;
    player.connect();
    player.describe();
    player.arrange(0, data.description.spacing === null ? 0 : 1);
    player.selectCamera(data.description.camera === null ? 0 : data.description.camera + 1);
    player.begin();
    // It also reports the first size, so that the first picture is drawn once.
    new ResizeObserver(() => player.resize()).observe(player.canvas.parentElement);
    requestAnimationFrame((now) => player.frame(now));
    return player;
  }

  createTracks({ description: { tracks, steps, frames }, binary }) {
    return tracks.map((track) => new Track(binary, track, steps, frames));
  }

  begin() {
    this.connectTimeline();
    const hash = /^#t=([\d.]+)$/.exec(location.hash);
    this.seek(hash ? Number(hash[1]) : this.start);
    const isStill = hash || this.start === this.end || matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.play(!isStill);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    this.stage.renderer.setPixelRatio(window.devicePixelRatio);
    this.stage.renderer.setSize(width, height, false);
    this.aspect = width / Math.max(height, 1);
    this.draw();
  }

  frame(now) {
    const elapsed = Math.min((now - (this.now ?? now)) / 1000, 0.1);
    this.now = now;
    this.tick(elapsed);
    if (this.isDirty && this.aspect) this.draw();
    requestAnimationFrame((next) => this.frame(next));
  }

  tick(elapsed) {
    if (!this.isPlaying) return;
    let time = this.time + elapsed * this.speed;
    if (time > this.end) {
      if (this.isLooping) time = this.start;
      else this.play(false);
    }
    this.seek(time);
  }

  draw() {
    this.isDirty = false;
    const camera = this.cameras.get(this.aspect);
    this.stage.draw(camera, this.cameras.target);
    document.documentElement.dataset.state = 'ready';
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    element('seek').value = this.time;
    element('time').textContent = `${this.time.toFixed(2)} / ${this.end.toFixed(2)} s`;
    const note = this.notes.filter(([at]) => at <= this.time && this.time < at + 2).pop();
    element('note').textContent = note ? note[1] : '';
    this.plots.draw(this.time);
    this.showPoses();
  }

  showPoses() {
    const followed = this.followed?.position;
    const before = followed?.clone();
    this.stage.setTime(this.time, this.count);
    if (followed) this.cameras.move(before, followed);
    this.showSelection();
    this.isDirty = true;
  }

  /** Goes to the next or the previous recorded time of the first track. */
  step(direction) {
    this.play(false);
    const { times } = this.tracks[0];
    const index = this.tracks[0].index(this.time);
    const isBetween = direction < 0 && this.time > times[index] + 1e-9;
    this.seek(times[Math.min(Math.max(isBetween ? index : index + direction, 0), times.length - 1)]);
  }

  play(isPlaying) {
    if (isPlaying && this.time >= this.end) this.seek(this.start);
    this.isPlaying = isPlaying;
    press('play', isPlaying);
    element('play').setAttribute('aria-label', isPlaying ? 'Pause' : 'Play');
  }

  setSpeed(speed) {
    this.speed = speed;
    element('speed').value = speed;
  }

  loop(isLooping) {
    this.isLooping = isLooping;
    press('loop', isLooping);
  }

  /** Moves the free camera with the selected body, or with the first that moves. */
  follow(isFollowing) {
    const frames = this.stage.frames[0];
    const moving = frames.findIndex((_, frame) => !this.tracks[0].isFixed(frame, this.tracks[0]));
    const frame = this.selected?.geom.frame || Math.max(moving, 0);
    this.followed = isFollowing ? frames[frame] : null;
    press('follow', isFollowing);
  }

  /** Draws a track in full, and the others as ghosts, side by side with it, or not at all. */
  arrange(chosen, layout) {
    this.select(undefined);
    const columns = this.count <= 4 ? this.count : Math.ceil(Math.sqrt(this.count));
    const isSideBySide = layout === 1;
    const offset = (index) => (isSideBySide ? [(index % columns) * this.spacing, Math.floor(index / columns) * this.spacing] : [0, 0]);
    const rows = Math.ceil(this.count / columns);
    this.cameras.include(isSideBySide ? [columns - 1, rows - 1].map((steps) => (steps * this.spacing) / 2) : [0, 0]);
    this.layout = { isSideBySide, isSingle: layout === 2, offset };
    this.stage.arrange(chosen, this.layout);
    [element('track').value, element('layout').value] = [chosen, layout];
    if (this.time !== undefined) this.showPoses();
  }

  selectCamera(index) {
    this.cameras.select(index);
    element('camera').value = index;
    this.isDirty = true;
  }

  /** Returns the ray at the place of an event. */
  ray(event) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const point = new Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(point, this.cameras.get(this.aspect));
    return ray;
  }

  /** Returns the first intersection with a geom at the place of an event. */
  hit(event) {
    const shown = this.stage.ghosts.meshes.filter((mesh) => mesh.visible);
    return this.ray(event).intersectObjects([...this.stage.meshes, ...shown], false)[0];
  }

  /** Selects the geom of an intersection: of a ghost, or of the track that is drawn in full. */
  select(hit) {
    if (this.selected) this.highlight(false);
    this.selected = hit && { mesh: hit.object, geom: hit.object.userData.geom, ghost: hit.instanceId };
    if (hit) this.highlight(true);
    this.showSelection();
    this.isDirty = true;
  }

  highlight(isSelected) {
    const { mesh, geom, ghost } = this.selected;
    if (ghost !== undefined) this.stage.ghosts.highlight(mesh, ghost, isSelected);
    else if (geom.shape !== 'plane') mesh.material.emissive.addScalar(isSelected ? 0.2 : -0.2);
  }

  showSelection() {
    const box = element('selection');
    box.hidden = !this.selected;
    if (!this.selected) return;
    const { geom, ghost } = this.selected;
    const place = ghost === undefined ? 0 : ghost + 1;
    const name = geom.frame === 0 ? 'world' : (this.bodies[geom.frame] ?? `body ${geom.frame}`);
    const { x, y, z } = this.stage.frames[place][geom.frame].position;
    const index = this.stage.order[place];
    const label = this.tracks[index].label || (this.count > 1 ? `${index}` : '');
    const lines = [
      ['Body', name],
      [geom.element === 'site' ? 'Site' : 'Geom', geom.name ?? `${geom.shape} without a name`],
      ['Position', `${x.toFixed(3)}, ${y.toFixed(3)}, ${z.toFixed(3)} m`],
    ];
    if (label) lines.push(['Trajectory', label]);
    box.replaceChildren(...lines.flatMap(([term, text]) => [tag('dt', term), tag('dd', text)]));
  }

  /** Fills the dialog: trajectories, what is not drawn, precision. */
  describe() {
    const { look, steps } = this.data;
    const labels = this.tracks.map(({ label }) => label).filter(Boolean);
    element('labels').textContent = labels.length > 0 ? `Trajectories: ${labels.join(', ')}` : '';
    element('left-out').textContent = look.left_out.length > 0 ? `Not drawn: ${look.left_out.join(', ')}` : '';
    const millimetres = ((steps.position * Math.sqrt(3)) / 2) * 1000;
    const degrees = (2 * Math.asin(steps.rotation) * 180) / Math.PI;
    element('precision').textContent =
      `Poses are rounded by at most ${millimetres.toPrecision(2)} mm and ${degrees.toPrecision(2)}°, and interpolated between the records.`;
    element('warning').hidden = look.left_out.length === 0;
  }

  connectTimeline() {
    this.plots = new Plots(element('plots'), this.tracks[0], (time) => this.seek(time));
    const seek = element('seek');
    Object.assign(seek, { min: this.start, max: this.end });
    seek.addEventListener('input', () => this.seek(Number(seek.value)));
    for (const [time, text] of this.notes) {
      const mark = tag('i', '');
      mark.title = text;
      mark.style.left = `${(100 * (time - this.start)) / (this.end - this.start || 1)}%`;
      element('marks').append(mark);
    }
    element('loop').addEventListener('click', () => this.loop(!this.isLooping));
    options('speed', SPEEDS, (speed) => `${speed}×`, (speed) => speed);
    element('speed').addEventListener('change', (event) => this.setSpeed(Number(event.target.value)));
    this.setSpeed(1);
    this.loop(true);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.plots.draw(this.time));
  }

  connect() {
    element('play').addEventListener('click', () => this.play(!this.isPlaying));
    element('follow').addEventListener('click', () => this.follow(!this.followed));
    for (const id of ['help', 'warning']) element(id).addEventListener('click', () => element('about').showModal());
    options('camera', this.cameras.list, ({ name }) => name, (_, index) => index);
    element('camera').addEventListener('change', (event) => this.selectCamera(Number(event.target.value)));
    const several = this.count > 1;
    element('tracks').hidden = element('layouts').hidden = !several;
    options('track', this.tracks, ({ label }, index) => label || `${index}`, (_, index) => index);
    options('layout', LAYOUTS, (name) => name, (_, index) => index);
    for (const id of ['track', 'layout']) {
      element(id).addEventListener('change', () => this.arrange(Number(element('track').value), Number(element('layout').value)));
    }
    let down = null;
    this.canvas.addEventListener('pointerdown', (event) => (down = [event.clientX, event.clientY]));
    this.canvas.addEventListener('pointerup', (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 5) this.select(this.hit(event));
      down = null;
    });
    window.addEventListener('keydown', (event) => this.key(event));
  }

  /** Actions of keys. */
  actions(event) {
    const faster = (step) => SPEEDS[Math.min(Math.max(SPEEDS.indexOf(this.speed) + step, 0), SPEEDS.length - 1)];
    const arrow = (direction) => (event.shiftKey ? this.seek(this.time + direction) : this.step(direction));
    return {
      ArrowLeft: () => arrow(-1),
      ArrowRight: () => arrow(1),
      ArrowUp: () => this.setSpeed(faster(1)),
      ArrowDown: () => this.setSpeed(faster(-1)),
      Home: () => this.seek(this.start),
      End: () => this.seek(this.end),
      l: () => this.loop(!this.isLooping),
    };
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || element('about').open) return;
    const isButton = event.target instanceof HTMLButtonElement;
    if (event.target instanceof HTMLSelectElement || (isButton && [' ', 'Enter'].includes(event.key))) return;
    const actions = {
      ...this.actions(event),
      ' ': () => this.play(!this.isPlaying),
      g: () => this.count > 1 && this.arrange(this.stage.order[0], (Number(element('layout').value) + 1) % LAYOUTS.length),
      f: () => this.follow(!this.followed),
      c: () => this.selectCamera((this.cameras.selected + 1) % this.cameras.list.length),
      Escape: () => this.select(undefined),
      '?': () => element('about').showModal(),
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}

export function tag(name, text) {
  const result = document.createElement(name);
  result.textContent = text;
  return result;
}

export function press(id, isPressed) {
  element(id).setAttribute('aria-pressed', isPressed);
}

function options(id, items, text, value) {
  items.forEach((item, index) => element(id).append(new Option(text(item, index), value(item, index))));
}
