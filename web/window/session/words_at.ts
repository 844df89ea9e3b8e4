// SPDX-License-Identifier: Apache-2.0
// The words of what an edit's place names: show/N, steps/NAME, picture, lights/N, environment, scene/NAME,
// keys/N/NAME, copies/N/NAME, points/NAME.
import type { SceneNode, State, Words } from "../protocol";

export function wordsAt(s: State, at: string): Words {
  const name = at.slice(at.indexOf("/") + 1);
  const node = (called: string): SceneNode | undefined => s.scene.find((n) => n.name === called);
  // N/NAME: the name of a node may have a / of its own.
  const ofNode = (): SceneNode | undefined => node(name.slice(name.indexOf("/") + 1));
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
      return node(name)?.words ?? {};
    case "keys":
      return ofNode()?.key_words[parseInt(name)] ?? {};
    case "copies":
      return ofNode()?.copy_words[parseInt(name)] ?? {};
    case "points":
      return node(name)?.points_words ?? {};
    default:
      return s.steps.find((x) => x.name === name)?.words ?? {};
  }
}
