// SPDX-License-Identifier: Apache-2.0
// Starts the window: connects and draws; the catalogue, which no picture needs, is fetched meanwhile.
import "./theme.css";
import { App } from "./app";
import type { Catalog } from "./catalog";
import { chooser, listing } from "./chooser";
import { draw } from "./shell";
import { applyTheme, followSystem } from "./theme";

async function catalogue(): Promise<Catalog> {
  const answer = await fetch("/catalog.json", { credentials: "same-origin", priority: "low" });
  if (answer.status === 401 || answer.status === 403) throw new Error("This address needs its token: use the whole address that sightglass printed.");
  if (!answer.ok) throw new Error(`The server answered ${answer.status} to /catalog.json`);
  return (await answer.json()) as Catalog;
}

async function start(): Promise<void> {
  const root = document.getElementById("app")!;
  applyTheme();
  try {
    const open = new URLSearchParams(location.search).get("open");
    if (new URLSearchParams(location.search).has("below")) return await chooser(root);
    const url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket${open ? `?open=${encodeURIComponent(open)}` : ""}`;
    root.replaceChildren();
    const app: App = new App(url, (a) => draw(a, root), async () => {
      // A server of a folder opens no session without a file's name: it is chosen first.
      if (!open && (await listing(""))) location.replace("/?below=");
    });
    followSystem(() => app.changed());
    draw(app, root); // at once: the size of the view is part of what is asked first
    app.connect();
    await app.session.met; // the first picture is asked for before it
    app.catalog = await catalogue();
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
