// SPDX-License-Identifier: Apache-2.0
// The other process: a renderer that does what comes over a socket.
#pragma once

namespace sg::serve {

/// Works until the other end of the socket has gone. The program calls it when it was started as a worker.
void run_worker(int socket);

}  // namespace sg::serve
