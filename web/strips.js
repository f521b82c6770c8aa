// Curves of the last ten seconds, drawn on canvases.

const SAMPLES = 600;
const SECONDS = 10;

export class Strip {
  /// scale: maps a value to a height, 0 at the bottom and 1 at the top. marks: values and their labels.
  constructor(canvas, { lines, scale, marks }) {
    this.canvas = canvas;
    this.scale = scale;
    this.marks = marks;
    this.set(lines);
  }

  set(lines) {
    this.times = new Float64Array(SAMPLES);
    this.values = Array.from({ length: lines }, () => new Float64Array(SAMPLES));
    this.clear();
  }

  clear() {
    this.next = this.count = 0;
  }

  add(time, values) {
    this.times[this.next] = time;
    this.values.forEach((line, i) => (line[this.next] = values[i]));
    this.next = (this.next + 1) % SAMPLES;
    this.count = Math.min(this.count + 1, SAMPLES);
  }

  draw(colors, look) {
    const { clientWidth, clientHeight } = this.canvas;
    const pixels = Math.min(window.devicePixelRatio, 2);
    const width = Math.round(clientWidth * pixels);
    const height = Math.round(clientHeight * pixels);
    if (width === 0 || height === 0) return;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    const pen = this.canvas.getContext("2d");
    pen.clearRect(0, 0, width, height);
    const [top, bottom] = [15 * pixels, 4 * pixels];
    const y = (value) => height - bottom - (height - top - bottom) * Math.min(Math.max(this.scale(value), 0), 1);
    this.drawMarks(pen, y, width, pixels, look);
    const last = this.times[(this.next + SAMPLES - 1) % SAMPLES];
    const x = (time) => width * (1 - (last - time) / SECONDS);
    pen.lineWidth = 1.75 * pixels;
    pen.lineJoin = "round";
    this.values.forEach((line, i) => {
      pen.strokeStyle = colors[i % colors.length];
      pen.beginPath();
      for (let k = 0; k < this.count; ++k) {
        const at = (this.next - this.count + k + SAMPLES) % SAMPLES;
        pen.lineTo(x(this.times[at]), y(line[at]));
      }
      pen.stroke();
    });
  }

  drawMarks(pen, y, width, pixels, look) {
    pen.font = `${10.5 * pixels}px system-ui, sans-serif`;
    pen.textBaseline = "bottom";
    pen.lineWidth = pixels;
    for (const [value, words] of this.marks) {
      const height = Math.round(y(value)) + 0.5;
      pen.strokeStyle = look.line;
      pen.beginPath();
      pen.moveTo(0, height);
      pen.lineTo(width, height);
      pen.stroke();
      pen.fillStyle = look.soft;
      pen.fillText(words, 2 * pixels, height - pixels);
    }
  }
}

/// Joint velocities in °/s: linear near zero, logarithmic far from zero, so that slow and fast motion are visible.
const squeeze = (value) => Math.asinh(value / 20);
export const speedScale = {
  scale: (value) => 0.5 + squeeze(value) / (2 * squeeze(180)),
  marks: [[180, "180 °/s"], [30, "30"], [0, "0"], [-30, "−30"], [-180, "−180"]],
};
export const errorScale = {
  scale: (value) => (Math.log10(Math.max(value, 1e-15)) + 15) / 15.5,
  marks: [[1, "1 m"], [1e-3, "1 mm"], [1e-6, "1 µm"], [1e-9, "1 nm"], [1e-12, "1 pm"]],
};
export const shareScale = { scale: (value) => value, marks: [[1, "100 %"], [0.5, "50 %"], [0, "0"]] };
