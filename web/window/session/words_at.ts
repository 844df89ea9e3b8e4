// SPDX-License-Identifier: Apache-2.0
// The words of what an edit's place names: show/N, steps/NAME, picture, lights/N, environment, scene/NAME.
import type { State, Words } from "../protocol";

export function wordsAt(s: State, at: string): Words {
  const name = at.slice(at.indexOf("/") + 1);
  switch (at.split("/", 1)[0]) {
    case "picture":
      return s.picture ?? {};
    case "environment":
      return s.environment?.words ?? {};
    case "show":
      return s.show[Number(name)]?.words ?? {};
    case "lights":
      return s.lights[Number(name)]?.words ?? {};
    case "scene":
      return s.scene.find((n) => n.name === name)?.words ?? {};
    default:
      return s.steps.find((x) => x.name === name)?.words ?? {};
  }
}
