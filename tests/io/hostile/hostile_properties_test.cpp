// SPDX-License-Identifier: Apache-2.0
// What holds for every file of every format, however it was damaged or changes meanwhile. Seeds are those of the fuzz target.
#include <fmt/core.h>
#include <sys/resource.h>

#include <chrono>
#include <fstream>

#include "data/memory/memory_budget.h"
#include "io/corpus.h"
#include "io/plausible.h"
#include "memory_cap.h"
#include "support/property.h"

using namespace sg;

namespace {

struct Source {
  const Format* format;
  std::string path;
};

// All seeds; of plug-ins those that are built.
const std::vector<Source>& sources() {
  static const std::vector<Source> all = [] {
    std::vector<Source> s;
    for (const Format& f : formats()) {
      const std::string slug = fuzz::slug(f.name), plugin(test::plugin_of(slug));
      if (!f.read || (!plugin.empty() && test::missing(plugin))) continue;
      for (const std::string& path : test::seeds_of(slug)) s.push_back({&f, path});
    }
    return s;
  }();
  return all;
}

std::string folder() { return test::corpus_folder() + "property/"; }

std::string put(const Source& s, std::string_view bytes) {
  std::filesystem::remove_all(folder());
  std::filesystem::create_directories(folder());
  return fuzz::put_seed(folder(), fuzz::file_name(*s.format), bytes);
}

// One of the ways in which files are wrong: bytes changed, numbers replaced by others, a part cut, doubled or moved.
std::string mutated(std::string bytes, test::Random& random) {
  const auto place = [&] { return size_t(random.in(0, double(std::max<size_t>(bytes.size(), 1)))); };
  for (int n = random.whole(1, 4); n > 0 && !bytes.empty(); --n) {
    const size_t at = place(), length = std::min(bytes.size() - at, size_t(random.magnitude(1, 400)));
    switch (random.whole(0, 6)) {
      case 0: bytes[at] = char(random.whole(0, 255)); break;
      case 1: bytes[at] = char(bytes[at] ^ (1 << random.whole(0, 7))); break;
      case 2: bytes.erase(at, length); break;
      case 3: bytes.insert(at, bytes.substr(place(), length)); break;
      case 4: bytes.resize(at); break;
      case 5: {  // a number of the text
        const size_t digit = bytes.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        const size_t end = std::min(bytes.find_first_not_of("0123456789", digit), bytes.size());
        bytes.replace(digit, end - digit,
                      random.one_of<const char*>(
                          {"0", "-1", "65536", "1000000", "2147483648", "4294967297", "9223372036854775807", "1e308", "nan", "0.0000001"}));
        break;
      }
      default: {  // a number of 4 or 8 bytes, in either order
        const uint64_t v = random.one_of<uint64_t>({0, 1, 1000000, 0x7fffffff, 0x80000000, 0xffffffff, uint64_t(1) << 33, UINT64_MAX});
        const size_t width = random.chance(0.5) ? 4 : 8;
        const bool big = random.chance(0.3);
        for (size_t k = 0; k < width && at + k < bytes.size(); ++k) bytes[at + k] = char(v >> (8 * (big ? width - 1 - k : k)));
      }
    }
  }
  return bytes;
}

}  // namespace

TEST_CASE("property: a damaged file of any format is read or refused within seconds and within the memory of its size") {
  const test::OneThread one;
  double slowest = 0;
  std::string which;
  for (const uint64_t seed : test::property_seeds(400)) {
    CAPTURE(seed);
    test::Random random(seed);
    const Source& s = sources()[size_t(random.in(0, double(sources().size())))];
    CAPTURE(s.path);
    const std::string bytes = mutated(std::string(MappedFile(s.path).text()), random), path = put(s, bytes);
    const auto begin = std::chrono::steady_clock::now();
    const size_t before = array_memory();
    Context context;
    try {
      const test::MemoryCap cap(size_t(1) << 30);
      ReadOptions options =
          random.chance(0.3) ? fuzz::rarer_options_of(*s.format, bytes, size_t(random.whole(0, 3))) : fuzz::options_of(*s.format, bytes);
      if (s.format->times) (void)file_times(path, options, context);
      const Data data = read_data(path, options, context);
      fuzz::look_at(data);
      for_each_dataset(data, [](const std::string&, const DatasetPtr& d) { validate(d->mesh()); });
      CHECK(array_memory() - before <= plausible_memory(2 * bytes.size()));
    } catch (const Error& e) {
      const std::string said = e.what();
      CHECK_MESSAGE(e.kind() != ErrorKind::internal, said);
      CHECK_MESSAGE(said.find("not enough memory") == std::string::npos, said);
    } catch (const std::bad_alloc&) {
      FAIL_CHECK("asks for more memory than there is");
    }
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (took > slowest) slowest = took, which = fmt::format("seed {} of {}", seed, s.path);
  }
  CAPTURE(which);
  CHECK(slowest < 30);
}

TEST_CASE("property: a mesh stays valid, and nothing crashes, when its file is written over or cut after it was read") {
  for (const uint64_t seed : test::property_seeds(200)) {
    CAPTURE(seed);
    test::Random random(seed);
    const Source& s = sources()[size_t(random.in(0, double(sources().size())))];
    CAPTURE(s.path);
    const std::string bytes(MappedFile(s.path).text()), path = put(s, bytes);
    Context context;
    Data data;
    try {
      data = read_data(path, fuzz::options_of(*s.format, bytes), context);
    } catch (const Error&) {
      continue;  // some seeds are wrong on purpose
    }
    std::error_code none;
    for (const auto& e : std::filesystem::recursive_directory_iterator(folder(), none)) {
      if (!e.is_regular_file(none)) continue;
      const auto size = size_t(e.file_size(none));
      if (random.chance(0.3)) {
        std::filesystem::resize_file(e.path(), size_t(random.in(0, double(size + 1))), none);
        continue;
      }
      std::fstream file(e.path(), std::ios::in | std::ios::out | std::ios::binary);
      const bool noise = random.chance(0.5);
      for (size_t i = 0; i < size; ++i) file.put(noise ? char(random.whole(0, 255)) : '\xff');
    }
    fuzz::look_at(data);
    for_each_dataset(data, [](const std::string&, const DatasetPtr& d) {
      if (!d->as<AmrGrid>() && d->point_count() < 100000) validate(d->mesh());
      for (size_t c = 0; c < cell_count(d->mesh()); c += 1 + cell_count(d->mesh()) / 50) (void)d->bounds();
    });
  }
}
