// Plots of the signals, with a cursor at the present time. A click or a drag seeks.

export class Plots {
  constructor(container, track, seek) {
    this.track = track;
    this.time = track.start;
    this.plots = track.curves.map(({ name, unit, values }) => {
      const figure = document.createElement('figure');
      const caption = document.createElement('figcaption');
      const [label, value] = [document.createElement('span'), document.createElement('output')];
      const canvas = document.createElement('canvas');
      label.textContent = name;
      caption.append(label, value);
      figure.append(caption, canvas);
      container.append(figure);
      const pick = (event) => {
        if (event.buttons === 0) return;
        const { left, width } = canvas.getBoundingClientRect();
        const part = Math.min(Math.max((event.clientX - left) / width, 0), 1);
        seek(track.start + part * (track.end - track.start));
      };
      canvas.addEventListener('pointerdown', (event) => {
        canvas.setPointerCapture(event.pointerId);
        pick(event);
      });
      canvas.addEventListener('pointermove', pick);
      const finite = values.filter(Number.isFinite);
      return { canvas, value, unit, values, range: finite.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]) };
    });
    container.hidden = this.plots.length === 0;
    new ResizeObserver(() => this.draw(this.time)).observe(container);
  }

  draw(time) {
    this.time = time;
    const { start, end, times } = this.track;
    const span = end - start || 1;
    const style = getComputedStyle(document.documentElement);
    const index = this.track.index(time);
    for (const { canvas, value, unit, values, range } of this.plots) {
      const { clientWidth: width, clientHeight: height } = canvas;
      const ratio = window.devicePixelRatio;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      const context = canvas.getContext('2d');
      context.scale(ratio, ratio);
      const [low, high] = range[0] < range[1] ? range : [range[0] - 1, range[0] + 1];
      const x = (t) => ((t - start) / span) * (width - 2) + 1;
      const y = (v) => height - 3 - ((v - low) / (high - low)) * (height - 6);
      const line = (colour, draw) => {
        context.strokeStyle = style.getPropertyValue(colour);
        context.beginPath();
        draw();
        context.stroke();
      };
      if (low < 0 && high > 0) line('--line', () => (context.moveTo(0, y(0)), context.lineTo(width, y(0))));
      context.lineWidth = 1.5;
      line('--accent', () => {
        let isPen = false;
        values.forEach((v, i) => {
          if (!Number.isFinite(v)) isPen = false;
          else if (isPen) context.lineTo(x(times[i]), y(v));
          else context.moveTo(x(times[i]), y(v)), (isPen = true);
        });
      });
      line('--text', () => (context.moveTo(x(time), 0), context.lineTo(x(time), height)));
      value.textContent = Number.isFinite(values[index]) ? `${values[index].toPrecision(4)} ${unit}`.trim() : 'no value';
    }
  }
}
