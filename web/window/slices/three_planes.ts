// SPDX-License-Identifier: Apache-2.0
// The three-plane view of scans: one step cuts along all axes through one point, and parallel cameras look along each of them. Planes
// seen edge-on have no width, so that each of these views shows its own plane only.
import type { App } from "../app";
import type { Edit } from "../protocol";

const solid = new Set(["uniform", "rectilinear", "curvilinear", "unstructured", "amr"]);

export function threePlanes(app: App): void {
  const s = app.state;
  if (!s) return;
  const source = s.steps.find((x) => x.name === s.show[0]?.of && solid.has(x.kind ?? "")) ?? s.steps.find((x) => solid.has(x.kind ?? ""));
  if (!source) {
    app.say("Three planes need data with volume");
    return;
  }
  if (!s.steps.some((x) => x.operation === "slice" && (x.words.planes ?? "none") !== "none")) {
    const old = s.show.flatMap((x, i) => (x.of === source.name && (x.kind === "volume" || x.kind === "surface") ? [i] : []));
    // From the last to the first, as each removal shifts the numbers behind it.
    const removals: Edit[] = old.reverse().map((i) => ({ remove: `show/${i}` }));
    app.session.edit([...removals, { add: "step", operation: "slice", from: [source.name], set: { planes: "xyz" } }]);
  }
  app.setLayout(4);
  app.link = "place";
  ["7", "1", "3", "5"].forEach((key, i) => app.lookAlong(key, app.views[i], i > 0));
}
