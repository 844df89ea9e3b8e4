// SPDX-License-Identifier: Apache-2.0
// What a window and its server say to each other, as the browser sees it.

/** Keeps the messages of a page's sockets, from before it is opened: the newest request for a picture of each view, and headers of all pictures. */
export function listenIn(page) {
  const heard = { draws: [], frames: [] };
  page.on("websocket", (socket) => {
    socket.on("framesent", ({ payload }) => {
      const message = typeof payload === "string" ? JSON.parse(payload) : null;
      if (message?.do === "draw") heard.draws[message.view] = message;
    });
    socket.on("framereceived", ({ payload }) => {
      if (typeof payload === "string") return;
      const bytes = Buffer.from(payload);
      heard.frames.push(JSON.parse(bytes.toString("utf8", 4, 4 + bytes.readUInt32LE(0))));
    });
  });
  return heard;
}
