// SPDX-License-Identifier: Apache-2.0
// The fuzz target of every reader: SG_FUZZ_FORMAT names the format (see tools/fuzz). Whatever the bytes are, a reader gives data
// that can be looked at, or throws sg::Error.
#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/io.h"

namespace {

const sg::Format* wanted = nullptr;
std::string path;

// "VTK XML" -> "vtk-xml": the name of the corpus folder.
std::string slug(std::string_view name) {
  std::string s = sg::to_lower(name);
  for (char& c : s)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '-';
  return s;
}

// Touches every number, so that the sanitizer sees an array that is longer than its bytes.
void look_at(const sg::Data& data) {
  sg::for_each_dataset(data, [](const std::string&, const sg::DatasetPtr& d) {
    (void)d->bounds();
    (void)sg::cell_type_counts(d->mesh());
    for (const sg::Field& f : d->fields()) (void)d->stats(f);
  });
  if (auto* table = std::get_if<sg::TablePtr>(&data))
    for (const sg::Field& f : (*table)->columns) (void)sg::field_stats(f.array);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("SG_FUZZ_FORMAT");
  for (const sg::Format& f : sg::formats()) {
    if (!name || std::strcmp(name, "list") == 0) std::printf("%s\n", slug(f.name).c_str());
    else if (slug(f.name) == name && f.read) wanted = &f;
  }
  if (!wanted) std::exit(name && std::strcmp(name, "list") == 0 ? 0 : 2);
  const char* folder = std::getenv("TMPDIR");
  path = fmt::format("{}/sightglass-fuzz-{}.{}", folder ? folder : "/dev/shm", ::getpid(), sg::words(wanted->extensions).empty() ? "bin" : sg::words(wanted->extensions)[0]);
  std::atexit([] { std::remove(path.c_str()); });
  sg::set_thread_count(1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return 0;
  std::fwrite(bytes, 1, size, file);
  std::fclose(file);
  sg::Context context;
  try {
    const sg::ReadOptions options;
    if (wanted->times) (void)wanted->times(path, options, context);
    look_at(wanted->read(path, options, context));
  } catch (const sg::Error& e) {
    if (e.kind() == sg::ErrorKind::internal) std::abort();  // a broken promise of ours, not of the file
  }
  return 0;
}
