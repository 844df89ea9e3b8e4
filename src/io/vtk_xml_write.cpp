// SPDX-License-Identifier: Apache-2.0
#include "io/formats.h"
namespace sg { void write_vtk_xml(const std::string&, const Data&, const WriteOptions&, Context&) { fail_internal("todo"); } }
