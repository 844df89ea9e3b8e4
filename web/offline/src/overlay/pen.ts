// SPDX-License-Identifier: Apache-2.0
// Letters and lines over the picture, set as src/render/annotate/overlay does.

const family = '"DejaVu Sans", Verdana, "Bitstream Vera Sans", "Helvetica Neue", Arial, sans-serif';
const ascent = 0.928, lineHeight = 1.164;  // of DejaVu Sans, in sizes

export interface Style {
  size: number;
  bold?: boolean;
  wrap?: number;
  centred?: boolean;
  color?: string;
  halo?: boolean;
  cut?: boolean;  // one line, cut with an ellipsis
}

export class Pen {
  readonly ink: string;
  readonly rim: string;
  /** `quick`: without rims round the letters, which cost most. */
  constructor(readonly context: CanvasRenderingContext2D, dark: boolean, private readonly quick = false) {
    this.ink = dark ? "rgb(237 237 242)" : "rgb(23 23 28)";
    this.rim = dark ? "rgb(13 13 18)" : "rgb(255 255 255)";
  }

  private lines(text: string, s: Style): string[] {
    const c = this.context;
    c.font = `${s.bold ? "bold " : ""}${s.size}px ${family}`;
    const plain = text.replaceAll("\u2060", "");
    if (!s.wrap || c.measureText(plain.replaceAll("\u200b", "")).width <= s.wrap * 1.002) return [plain.replaceAll("\u200b", "")];
    if (s.cut) {
      let n = plain.length;
      while (n > 1 && c.measureText(plain.slice(0, n) + "…").width > s.wrap) --n;
      return [plain.slice(0, n) + "…"];
    }
    const out: string[] = [];
    let line = "";
    for (const word of plain.split(/(?<=[ \u200b])/)) {
      if (line && c.measureText((line + word).trimEnd().replaceAll("\u200b", "")).width > s.wrap * 1.002) out.push(line), line = "";
      line += word;
    }
    return [...out, line].map((l) => l.replaceAll("\u200b", "").trimEnd());
  }

  measure(text: string, s: Style): { width: number; height: number; lines: number } {
    const lines = this.lines(text, s);
    return { width: Math.max(...lines.map((l) => this.context.measureText(l).width)), height: lines.length * lineHeight * s.size, lines: lines.length };
  }

  /** Its upper left corner at (x, y). */
  text(text: string, x: number, y: number, s: Style): void {
    const c = this.context, lines = this.lines(text, s), width = Math.max(...lines.map((l) => c.measureText(l).width));
    c.textBaseline = "alphabetic", c.textAlign = "left", c.lineJoin = "round";
    lines.forEach((line, i) => {
      const at = x + (s.centred ? 0.5 * (width - c.measureText(line).width) : 0), base = y + (i * lineHeight + ascent) * s.size;
      if (s.halo && !this.quick) c.strokeStyle = this.rim, c.lineWidth = 0.2 * s.size, c.strokeText(line, at, base);
      c.fillStyle = s.color ?? this.ink;
      c.fillText(line, at, base);
    });
  }

  /** Its middle at (x, y), turned by an angle anticlockwise. */
  turned(text: string, x: number, y: number, angle: number, s: Style): void {
    const c = this.context, e = this.measure(text, s);
    c.save();
    c.translate(x, y), c.rotate(-angle);
    this.text(text, -0.5 * e.width, -0.5 * e.height, s);
    c.restore();
  }

  line(x0: number, y0: number, x1: number, y1: number, width: number, color = this.ink, alpha = 1): void {
    const c = this.context;
    c.globalAlpha = alpha, c.strokeStyle = color, c.lineWidth = width, c.lineCap = "butt";
    c.beginPath(), c.moveTo(x0, y0), c.lineTo(x1, y1), c.stroke();
    c.globalAlpha = 1;
  }
  polygon(points: [number, number][], fill: string, outlined = false): void {
    const c = this.context;
    c.beginPath();
    points.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y)));
    c.closePath();
    c.fillStyle = fill, c.fill();
    if (outlined) c.globalAlpha = 0.35, c.strokeStyle = this.ink, c.lineWidth = 1, c.stroke(), c.globalAlpha = 1;
  }
  frame(x: number, y: number, width: number, height: number): void {
    const c = this.context;
    c.globalAlpha = 0.35, c.strokeStyle = this.ink, c.lineWidth = 1;
    c.strokeRect(x - 0.5, y - 0.5, width + 1, height + 1);
    c.globalAlpha = 1;
  }
}
