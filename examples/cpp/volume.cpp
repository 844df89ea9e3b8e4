// SPDX-License-Identifier: Apache-2.0
// A volume picture of a file, with progress, and an end at Ctrl-C: volume IN OUT.png
#include <sightglass/sightglass.h>

#include <csignal>
#include <cstdio>

namespace {
sg::Context work;
}

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: volume IN OUT.png\n"), 2;
  std::signal(SIGINT, [](int) { work.cancel(); });
  work.on_progress([](double fraction, std::string_view doing) {
    std::fprintf(stderr, "\r%3.0f%% %.*s\x1b[K", 100 * fraction, int(doing.size()), doing.data());
  });
  try {
    const sg::Data data = sg::read(argv[1], {}, work);
    for (const sg::Field& f : data.fields()) {
      const sg::Range r = data.range(f.name);
      std::printf("%s: %g to %g %s\n", f.name.c_str(), r.lo, r.hi, f.unit.c_str());
    }
    const sg::Image image =
        sg::Scene().show(data, "volume").camera({{"view", "iso"}}).picture({{"background", "black"}}).render(800, 600, work);
    for (const std::string& note : image.notes()) std::printf("%s\n", note.c_str());

    // Pixels are at hand, too: how much of the picture is not background?
    size_t drawn = 0;
    const auto pixels = image.pixels();
    for (size_t i = 0; i < pixels.size(); i += size_t(image.channels())) drawn += pixels[i] || pixels[i + 1] || pixels[i + 2];
    std::printf("%zu of %d pixels\n", drawn, image.width() * image.height());
    image.write(argv[2]);
  } catch (const sg::Error& e) {
    std::fprintf(stderr, "\n%s\n", e.what());
    return e.kind() == sg::Error::Kind::cancelled ? 130 : 1;
  }
}
