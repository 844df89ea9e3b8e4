// SPDX-License-Identifier: Apache-2.0
// The pipeline of the stand-in server: edits, undo, and the command line that draws it.

const quoted = (text) => `'${String(text).replaceAll("'", "\\'")}'`;
const words = (set) => Object.entries(set).map(([k, v]) => `${k}=${/[\s']/.test(v) || v === "" ? JSON.stringify(v) : v}`).join(" ");

export class Pipeline {
  constructor(file, title, info) {
    this.info = info;
    this.title = title;
    this.now = {
      steps: [{ name: "data", operation: "read", words: { path: file }, from: [] }],
      show: [{ kind: info.show, of: "data", words: { ...info.words } }],
      picture: {},
    };
    this.past = [];
    this.future = [];
    this.revision = 1;
    this.live = ""; // the words that a drag sets
    this.time = info.times[0] ?? null;
  }

  /** Applies edits; returns the errors, and changes nothing if there are any. */
  edit(edits, live) {
    const next = structuredClone(this.now);
    const errors = [];
    for (const e of edits) this.apply(next, e, errors);
    if (errors.length > 0) return errors;
    // A drag is one step of undo: its live edits, and the one that ends it, replace one another.
    const words = JSON.stringify(edits.map((e) => [e.at, Object.keys(e.set ?? {}).sort()]));
    if (this.live !== words) this.past.push(this.now);
    this.live = live ? words : "";
    this.future = [];
    this.now = next;
    this.revision++;
    return [];
  }

  apply(p, e, errors) {
    const bad = (at, word, text) => errors.push({ at, word, text });
    if (e.from && e.at) {
      const step = p.steps.find((s) => `steps/${s.name}` === e.at);
      if (!step) return bad(e.at, "", `'${e.at}' not found`);
      step.from = e.from;
    } else if (e.at) {
      const target =
        e.at === "picture" ? p.picture : e.at.startsWith("show/") ? p.show[+e.at.slice(5)]?.words : p.steps.find((s) => s.name === e.at.slice(6))?.words;
      if (!target) return bad(e.at, "", `'${e.at}' not found`);
      for (const [k, v] of Object.entries(e.set)) {
        if (v === null) delete target[k];
        else if (/^(values|range)$/.test(k) && v.split(",").some((x) => !Number.isFinite(Number(x)))) bad(e.at, k, `'${v}' is not a list of numbers`);
        else target[k] = v;
      }
    } else if (e.add === "step") {
      const n = p.steps.filter((s) => s.operation === e.operation).length + 1;
      const name = `${e.operation}${n}`;
      p.steps.push({ name, operation: e.operation, words: { ...e.set }, from: e.from });
      this.redirect(p, e.before, e.from[0], name);
      if (e.show !== false) p.show.push({ kind: /lines/.test(e.operation) ? "lines" : "surface", of: name, words: {} });
    } else if (e.add === "show") p.show.push({ kind: e.kind, of: e.of, words: { ...e.set } });
    else if (e.remove?.startsWith("show/")) p.show.splice(+e.remove.slice(5), 1);
    else if (e.remove) {
      const name = e.remove.slice(6);
      this.redirect(p, e.join, name, p.steps.find((s) => s.name === name)?.from[0]);
      const user = p.steps.find((s) => s.from.includes(name));
      if (user) return bad(e.remove, "", `'${name}' is taken by '${user.name}'`);
      p.steps = p.steps.filter((s) => s.name !== name);
      p.show = p.show.filter((s) => s.of !== name);
    }
  }

  /** What stands at those places takes another step than before. */
  redirect(p, places, before, now) {
    for (const place of places ?? []) {
      const step = p.steps.find((s) => `steps/${s.name}` === place);
      if (step) step.from = step.from.map((f) => (f === before ? now : f));
      else if (place.startsWith("show/")) p.show[+place.slice(5)].of = now;
    }
  }

  undo() {
    if (this.past.length === 0) return;
    this.future.push(this.now);
    this.now = this.past.pop();
    this.revision++;
    this.live = "";
  }

  redo() {
    if (this.future.length === 0) return;
    this.past.push(this.now);
    this.now = this.future.pop();
    this.revision++;
  }

  command() {
    const [read, ...others] = this.now.steps;
    const args = ["render", read.words.path];
    for (const s of others) args.push("-f", `${s.name}: ${s.operation} ${words(s.words)} on=${s.from[0] === read.name ? "input" : s.from[0]}`.trim());
    for (const s of this.now.show) args.push("--show", `${s.kind} ${words(s.words)}${s.of === read.name ? (others.length ? " of=input" : "") : ` of=${s.of}`}`.trim());
    const picture = words(this.now.picture);
    if (picture) args.push("--picture", ...Object.entries(this.now.picture).map(([k, v]) => `${k}=${v}`));
    return args;
  }

  text() {
    const block = (w) => `{${Object.entries(w).map(([k, v]) => `${k}: ${JSON.stringify(v)}`).join(", ")}}`;
    return [
      "sightglass: 1",
      "steps:",
      ...this.now.steps.map((s) => `  ${s.name}: {${s.operation}: ${block(s.words)}${s.from.length ? `, from: ${s.from.join(", ")}` : ""}}`),
      "show:",
      ...this.now.show.map((s) => `  - {${s.kind}: ${block(s.words)}, of: ${s.of}}`),
      ...(Object.keys(this.now.picture).length ? [`picture: ${block(this.now.picture)}`] : []),
      "",
    ].join("\n");
  }

  state(by) {
    const { info } = this;
    return {
      is: "state",
      revision: this.revision,
      by,
      can_undo: this.past.length > 0,
      can_redo: this.future.length > 0,
      title: this.title,
      saves: { types: ["png"], most_pixels: 4096 * 4096 },
      may_edit: true,
      pipeline: this.text(),
      command: ["sightglass", ...this.command().map((a) => (/^[\w./=:-]+$/.test(a) ? a : quoted(a)))].join(" "),
      steps: this.now.steps.map((s, i) => ({
        ...s,
        kind: i === 0 ? info.kind : "surface",
        size: i === 0 ? info.size : "12 345 points",
        fields: info.fields,
        bytes: i === 0 ? 12_300_000 : 2_400_000 / (i + 1),
        seconds: i === 0 ? 0.12 : 0.034 * i,
      })),
      show: this.now.show.map((s) => ({ ...s, transfer: this.transfer(s) })),
      picture: this.now.picture,
      lights: [],
      environment: null,
      scene: [],
      times: info.times,
      time: this.time,
      bounds: info.bounds,
      length_unit: "mm",
      camera: info.camera,
      notes: info.notes,
    };
  }

  transfer(show) {
    const { info } = this;
    const field = info.fields.find((f) => f.name === show.words.field) ?? info.fields[0];
    if (!field || show.words.color) return null;
    const [a, b] = show.words.range ? show.words.range.split(",").map(Number) : field.range;
    const map = show.words.map ?? "sight";
    const counts = Array.from({ length: 256 }, (_, i) => Math.round(9000 * Math.exp(-((i - 40) ** 2) / 200) + 3000 * Math.exp(-((i - 130) ** 2) / 900) + 40000 * (i < 3)));
    return {
      field: field.name,
      unit: field.unit ?? "",
      range: [a, b],
      scale: show.words.scale ?? "linear",
      map,
      ...info.map(map),
      opacity_unit: 1,
      ...(show.kind === "volume" ? { opacity: info.opacity(show.words.opacity, a, b) } : {}),
      histogram: { range: field.range, counts },
    };
  }
}
