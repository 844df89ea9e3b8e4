// SPDX-License-Identifier: Apache-2.0
#include "serve/door/catalog_text.h"

#include "pipeline/catalog/catalog.h"

namespace sg::serve {

std::string catalog_text() { return catalog_json(catalog()); }

}  // namespace sg::serve
