// View of a running simulation, whose states come from a WebSocket (src/live/mod.rs).

import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, Plane, Vector3 } from 'three';
import { Player, element, press, tag } from './main.js';

/** Number of requested states on their way, so that a slow connection is used well. */
const REQUESTS = 3;
/** Times between attempts to connect, ms. */
const RETRY = [500, 5000];
/** Period of the numbers beside the picture, ms. */
const TEXT_PERIOD = 100;
const HELP = [
  ['Drag, one finger', 'rotate the free camera'],
  ['Right button, two fingers', 'move it'],
  ['Wheel, pinch', 'zoom'],
  ['Click, tap', 'names of a geom and its body'],
  ['Drag a body with Ctrl, or with Pull', 'pull it; while paused, move a body that is free'],
  ['Space, →', 'pause or resume, one step'],
  ['R, P', 'reset, pull'],
  ['C, F', 'next camera, follow the selected body'],
  ['G', 'ghosts, side by side, or one simulation'],
  ['Sliders', 'hold controls; × leaves a control to the program'],
  ['Escape', 'clear the selection'],
];

/** Latest state of a simulation, with the methods of a recorded track. */
class LiveTrack {
  constructor(frames) {
    this.label = '';
    this.start = this.end = this.time = 0;
    this.poses = new Float32Array(7 * frames);
    for (let frame = 0; frame < frames; frame++) this.poses[7 * frame + 3] = 1;
    this.deformables = [];
  }

  pose(_, objects) {
    objects.forEach((object, frame) => {
      const [x, y, z, qw, qx, qy, qz] = this.poses.subarray(7 * frame, 7 * frame + 7);
      object.position.set(x, y, z);
      object.quaternion.set(qx, qy, qz, qw);
    });
  }

  vertices(index) {
    return this.deformables[index];
  }

  isFixed(frame) {
    return frame === 0;
  }
}

/** Reads a state (src/live/state.rs) into tracks, and returns the rest of it. */
function read(buffer, tracks, controls) {
  const view = new DataView(buffer);
  const [flags, count] = [view.getUint32(0, true), view.getUint32(4, true)];
  let at = 8 + 8 * count;
  const numbers = (length) => {
    at += 4 * length;
    return new Float32Array(buffer, at - 4 * length, length);
  };
  tracks.slice(0, count).forEach((track, index) => {
    track.time = view.getFloat64(8 + 8 * index, true);
    track.poses = numbers(track.poses.length);
  });
  const ctrl = numbers(controls);
  tracks[0].deformables = tracks[0].deformables.map(() => {
    at += 4;
    return numbers(3 * view.getUint32(at - 4, true));
  });
  const held = new Uint8Array(buffer, at, controls);
  const problem = new TextDecoder().decode(new Uint8Array(buffer, at + controls));
  return { isPaused: (flags & 1) !== 0, isBatch: (flags & 2) !== 0, count, ctrl, held, problem };
}

export class LivePlayer extends Player {
  createTracks({ description }) {
    const { frames, live, look } = description;
    const tracks = Array.from({ length: 1 + live.ghosts }, () => new LiveTrack(frames));
    tracks[0].deformables = look.deformables.map(() => new Float32Array(0));
    return tracks;
  }

  begin() {
    for (const id of ['timeline', 'speed', 'loop']) element(id).hidden = true;
    for (const [id, text, title, action] of [
      ['advance', 'Step', 'One step, while paused (→)', () => this.step()],
      ['reset', 'Reset', 'Back to the start (R)', () => this.reset()],
      ['pull', 'Pull', 'Dragging a body pulls it (P, or with Ctrl)', () => this.togglePull()],
      ['show', 'Controls', 'Show the controls', () => this.showControls(element('plots').hidden)],
    ]) {
      const button = tag('button', text);
      Object.assign(button, { id, title, type: 'button' });
      button.addEventListener('click', action);
      element('play').parentElement.insertBefore(button, element('timeline'));
    }
    element('time').before(Object.assign(tag('span', ''), { id: 'gap' }));
    element('about').querySelector('dl').replaceChildren(...HELP.flatMap(([a, b]) => [tag('dt', a), tag('dd', b)]));
    element('precision').textContent = 'Poses are in single precision.';
    element('play').title = 'Pause or resume (space)';
    press('pull', false);
    this.createSliders();
    this.connectHand();
    this.delay = RETRY[0];
    this.speeds = [];
    this.open();
  }

  createSliders() {
    this.sliders = this.data.live.sliders.map(([name, [low, high]], index) => {
      const row = document.createElement('label');
      const input = document.createElement('input');
      const release = tag('button', '×');
      const value = document.createElement('output');
      Object.assign(input, { type: 'range', min: low, max: high, step: (high - low) / 1000 || 'any' });
      Object.assign(release, { type: 'button', title: 'Leave the control to the program' });
      release.setAttribute('aria-label', 'Release');
      input.addEventListener('input', () => this.send({ hold: [index, Math.min(Math.max(Number(input.value), low), high)] }));
      release.addEventListener('click', () => this.send({ release: index }));
      row.append(tag('span', name ?? `control ${index}`), value, input, release);
      element('plots').append(row);
      return { row, input, value };
    });
    element('plots').setAttribute('aria-label', 'Controls');
    element('plots').classList.add('controls');
    element('show').hidden = this.sliders.length === 0;
    this.showControls(this.sliders.length > 0 && !matchMedia('(max-width: 640px)').matches);
  }

  showControls(isShown) {
    element('plots').hidden = !isShown;
    press('show', isShown);
  }

  open() {
    const address = location.href.replace(/^http/, 'ws').replace(/[/]*([?#].*)?$/, '/live');
    this.socket = new WebSocket(address);
    this.socket.binaryType = 'arraybuffer';
    this.requests = 0;
    this.socket.addEventListener('open', () => (this.delay = RETRY[0]));
    this.socket.addEventListener('message', ({ data }) => this.receive(data));
    this.socket.addEventListener('close', ({ reason }) => {
      this.note = `No connection to the program${reason ? ` (${reason})` : ''}. Trying again …`;
      element('note').textContent = this.note;
      document.documentElement.dataset.live = 'lost';
      setTimeout(() => this.open(), this.delay);
      this.delay = Math.min(2 * this.delay, RETRY[1]);
    });
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  receive(buffer) {
    this.requests -= 1;
    this.note = '';
    this.state = read(buffer, this.tracks, this.sliders.length);
    this.isNew = true;
    document.documentElement.dataset.live = 'open';
  }

  /** Requests a state for each frame, and shows the latest. A hidden page requests none. */
  tick() {
    if (this.pulled) this.drag();
    if (this.socket.readyState === WebSocket.OPEN && this.requests < REQUESTS) {
      this.requests += 1;
      this.send('next');
    }
    if (!this.isNew) return;
    this.isNew = false;
    this.time = this.tracks[this.stage.order[0]].time;
    if (this.count !== this.state.count) this.setCount(this.state.count);
    this.showPoses();
    this.showRope();
    if (!(this.now < this.nextText)) this.showTexts();
  }

  showTexts() {
    this.nextText = this.now + TEXT_PERIOD;
    const { ctrl, held, isBatch, isPaused, problem } = this.state;
    const { time } = this;
    element('pull').hidden = isBatch;
    element('show').hidden = isBatch || this.sliders.length === 0;
    if (isBatch && !element('plots').hidden) this.showControls(false);
    this.isPlaying = !isPaused;
    press('play', this.isPlaying);
    element('play').setAttribute('aria-label', this.isPlaying ? 'Pause' : 'Resume');
    element('advance').disabled = this.isPlaying;
    this.speeds = [...this.speeds.filter(([, before]) => before <= time), [this.now, time]].slice(-10);
    const [[now, before]] = this.speeds;
    const speed = this.isPlaying && this.now > now ? `, ${((1000 * (time - before)) / (this.now - now)).toFixed(2)}×` : '';
    element('time').textContent = `${time.toFixed(2)} s${speed}`;
    element('note').textContent = problem ? `${isBatch ? '' : 'Stopped: '}${problem}. Reset to go on.` : this.note;
    this.sliders.forEach(({ row, input, value }, index) => {
      row.classList.toggle('held', held[index] === 1);
      const text = Number(ctrl[index].toPrecision(3)).toString();
      if (value.textContent !== text) value.textContent = text;
      if (!input.matches(':active')) input.value = ctrl[index];
    });
  }

  /** The number of simulations can change. */
  setCount(count) {
    this.count = count;
    element('tracks').hidden = element('layouts').hidden = count < 2;
    const chosen = this.stage.order[0];
    [...element('track').options].forEach((option, index) => (option.hidden = option.disabled = index >= count));
    this.arrange(chosen < count ? chosen : 0, Number(element('layout').value));
  }

  play(isPlaying) {
    this.send({ pause: !isPlaying });
  }

  step() {
    this.send({ step: 1 });
  }

  reset() {
    this.send('reset');
  }

  togglePull() {
    this.isPulling = !this.isPulling;
    press('pull', this.isPulling);
  }

  actions({ target }) {
    const actions = { r: () => this.reset(), p: () => this.togglePull() };
    // The arrows move a slider that has the focus.
    return target instanceof HTMLInputElement ? actions : { ...actions, ArrowRight: () => this.step() };
  }

  /** Pulls a body by the pointer, before the camera's controls receive its events. */
  connectHand() {
    const points = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(6), 3));
    this.rope = new Line(points, new LineBasicMaterial({ color: 0xff3020, depthTest: false }));
    Object.assign(this.rope, { visible: false, frustumCulled: false });
    this.stage.scene.add(this.rope);
    const start = (event) => {
      if (this.pulled) event.stopPropagation();
      if (this.pulled || event.button !== 0 || !(this.isPulling || event.ctrlKey) || event.target !== this.canvas) return;
      const hit = this.hit(event);
      if (!hit || hit.instanceId !== undefined || this.stage.order[0] !== 0 || this.state?.isBatch) return;
      if (hit.object.userData.geom.frame === 0) return;
      event.stopPropagation();
      event.preventDefault();
      this.canvas.setPointerCapture(event.pointerId);
      const frame = hit.object.parent;
      const direction = this.cameras.get(this.aspect).getWorldDirection(new Vector3());
      this.select(hit);
      this.pulled = {
        pointer: event.pointerId,
        body: hit.object.userData.geom.frame,
        frame,
        point: frame.worldToLocal(hit.point.clone()),
        plane: new Plane().setFromNormalAndCoplanarPoint(direction, hit.point),
        target: hit.point.clone(),
      };
      this.drag();
    };
    const move = (event) => {
      if (event.pointerId !== this.pulled?.pointer) return;
      event.stopPropagation();
      const target = this.ray(event).ray.intersectPlane(this.pulled.plane, new Vector3());
      if (target) Object.assign(this.pulled, { target, isOld: false });
    };
    const end = (event) => {
      if (event.pointerId !== this.pulled?.pointer) return;
      event.stopPropagation();
      this.pulled = null;
      this.send('let_go');
      this.showRope();
      this.isDirty = true;
    };
    const capture = { capture: true };
    window.addEventListener('pointerdown', start, capture);
    window.addEventListener('pointermove', move, capture);
    for (const name of ['pointerup', 'pointercancel']) window.addEventListener(name, end, capture);
    window.addEventListener('contextmenu', (event) => event.ctrlKey && event.preventDefault());
  }

  /** Sends the target, if it has changed. */
  drag() {
    if (this.pulled.isOld) return;
    this.pulled.isOld = true;
    const { body, point, target } = this.pulled;
    this.send({ pull: { body, point: point.toArray(), target: target.toArray() } });
  }

  showRope() {
    this.rope.visible = Boolean(this.pulled);
    if (!this.pulled) return;
    const position = this.rope.geometry.getAttribute('position');
    this.pulled.frame.updateWorldMatrix(true, false);
    this.pulled.frame.localToWorld(this.pulled.point.clone()).toArray(position.array, 0);
    this.pulled.target.toArray(position.array, 3);
    position.needsUpdate = true;
  }
}
