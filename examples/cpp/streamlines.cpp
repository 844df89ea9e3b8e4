// SPDX-License-Identifier: Apache-2.0
// An operation by name with typed values, and what happens when one of them is wrong: streamlines OUT.png
#include <sightglass/sightglass.h>

#include <cstdio>

int main(int argc, char** argv) {
  try {
    const sg::Data flow = sg::source("abc", {{"size", 48}});

    try {
      flow.run("streamlines", {{"tolerence", 1e-5}});  // the schema knows
    } catch (const sg::Error& e) {
      std::printf("refused: %s\n", e.what());
    }

    const sg::Data lines =
        flow.run("streamlines", {{"field", "velocity"}, {"count", 150}, {"integrator", "dormand_prince"}, {"tolerance", 1e-5}});
    std::printf("%s\n", lines.summary().c_str());
    for (const sg::Field& f : lines.fields()) std::printf("  %s, %d components\n", f.name.c_str(), f.values.components());

    const sg::Data tubes = lines.run("tubes");
    sg::Scene()
        .show(tubes, "auto", {{"field", "velocity"}})
        .picture({{"title", "ABC flow"}})
        .render(800, 600)
        .write(argc > 1 ? argv[1] : "streamlines.png");
  } catch (const sg::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
