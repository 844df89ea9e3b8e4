// SPDX-License-Identifier: Apache-2.0
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

// The text libraries are not compiled with the sanitizers: Pango reads the fonts in a thread of its own and hands them over with locks
// that ThreadSanitizer cannot see, and Fontconfig keeps its tables until the program ends. Reports from inside them are not about us.
#if defined(__SANITIZE_THREAD__)
extern "C" __attribute__((visibility("default"))) const char* __tsan_default_suppressions() {
  return "race:libfontconfig.so\nrace:libpangoft2\nrace:libglib-2.0.so\n";
}
#endif
#if defined(__SANITIZE_ADDRESS__)
extern "C" __attribute__((visibility("default"))) const char* __lsan_default_suppressions() { return "leak:libfontconfig.so\n"; }
#endif
