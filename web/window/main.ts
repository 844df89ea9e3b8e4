// SPDX-License-Identifier: Apache-2.0
// Starts the window: fetches the catalogue, connects, and draws.
import "./theme.css";
import { App } from "./app";
import type { Catalog } from "./catalog";
import { chooser, listing } from "./chooser";
import { draw } from "./shell";
import { applyTheme, followSystem } from "./theme";

async function start(): Promise<void> {
  const root = document.getElementById("app")!;
  applyTheme();
  try {
    const answer = await fetch("/catalog.json", { credentials: "same-origin" });
    if (answer.status === 401 || answer.status === 403) throw new Error("This address needs its token: use the whole address that sightglass printed.");
    if (!answer.ok) throw new Error(`The server answered ${answer.status} to /catalog.json`);
    const catalog = (await answer.json()) as Catalog;
    const open = new URLSearchParams(location.search).get("open");
    if (new URLSearchParams(location.search).has("below")) return await chooser(root);
    const url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket${open ? `?open=${encodeURIComponent(open)}` : ""}`;
    root.replaceChildren();
    const app: App = new App(catalog, url, (a) => draw(a, root), async () => {
      // A server of a folder opens no session without a file's name: it is chosen first.
      if (!open && (await listing(""))) location.replace("/?below=");
    });
    followSystem(() => app.changed());
    app.changed();
  } catch (error) {
    root.replaceChildren();
    const p = document.createElement("p");
    p.className = "starting";
    p.setAttribute("role", "alert");
    p.textContent = (error as Error).message;
    root.append(p);
  }
}

void start();
