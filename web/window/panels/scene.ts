// SPDX-License-Identifier: Apache-2.0
// The tab of the scene: its lights, what is around, and nodes with what stands in them.
import { html, type TemplateResult } from "lit";
import type { App } from "../app";
import { lightsPanel } from "./lights";
import { nodesPanel } from "./nodes";

export const scenePanel = (app: App): TemplateResult => html`${lightsPanel(app)}${nodesPanel(app)}`;
