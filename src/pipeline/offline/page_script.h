// SPDX-License-Identifier: Apache-2.0
// What a page runs: web/dist/offline.js, which is built from web/offline.
#pragma once

namespace sg::offline {

const char* page_script();

}  // namespace sg::offline
