// SPDX-License-Identifier: Apache-2.0
// The fuzz target of every reader: SG_FUZZ_FORMAT names the format (see tools/fuzz). Whatever the bytes are, a reader gives data
// that can be looked at, or throws sg::Error. An input may be several files (bundle.h).
#include "fuzz.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "base/parallel.h"

namespace {

const sg::Format* wanted = nullptr;
std::string folder;
const bool verbose = std::getenv("SG_FUZZ_VERBOSE") != nullptr;  // to look at single files

void read(const std::string& path, const sg::ReadOptions& options) {
  sg::Context context;
  try {
    if (wanted->times) (void)wanted->times(path, options, context);
    sg::fuzz::look_at(wanted->read(path, options, context));
    if (verbose) std::fprintf(stderr, "read\n");
  } catch (const sg::Error& e) {
    if (verbose) std::fprintf(stderr, "%s\n", e.what());
    if (e.kind() != sg::ErrorKind::internal) return;
    std::fprintf(stderr, "ERROR: internal: %s\n", e.what());  // a broken promise of ours, not of the file
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("SG_FUZZ_FORMAT");
  for (const sg::Format& f : sg::formats()) {
    const std::string slug = sg::fuzz::slug(f.name);
    if (!name || std::string_view(name) == "list") std::printf("%s\n", slug.c_str());
    else if (slug == name && f.read) wanted = &f;
  }
  if (!wanted) std::exit(name && std::string_view(name) == "list" ? 0 : 2);
  const char* where = std::getenv("TMPDIR");
  folder = fmt::format("{}/sightglass-fuzz-{}/", where ? where : "/dev/shm", ::getpid());
  std::atexit([] {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  });
  sg::set_thread_count(1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  std::error_code ignored;
  const std::string_view input(reinterpret_cast<const char*>(bytes), size);
  static bool dirty = true;
  if (dirty) std::filesystem::remove_all(folder, ignored), std::filesystem::create_directories(folder, ignored);
  dirty = input.starts_with("@@ ");
  const std::string path = sg::fuzz::put_seed(folder, sg::fuzz::file_name(*wanted), input);
  read(path, sg::fuzz::options_of(*wanted, input));
  read(path, sg::fuzz::rarer_options_of(*wanted, input, size));
  return 0;
}
