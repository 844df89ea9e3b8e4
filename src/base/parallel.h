// SPDX-License-Identifier: Apache-2.0
// Parallel loops whose result does not depend on the number of threads: chunk borders depend on n and grain alone.
#pragma once
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace sg {

class Context;

/// Caps the worker threads of the process; 0 = all cores.
void set_thread_count(int n);
int thread_count();

namespace detail {
using ChunkFn = void (*)(void* body, size_t chunk);
void run_chunks(size_t chunks, ChunkFn fn, void* body, const Context* context);
}  // namespace detail

/// Calls f(begin, end) for the chunks [i*grain, min(n, (i+1)*grain)) on all threads. With a context, each chunk polls its
/// cancel flag first. Of the exceptions that chunks throw that of the lowest one is rethrown: the same on any number of threads.
template <class F>
void parallel_for(size_t n, size_t grain, F&& f, const Context* context = nullptr) {
  if (n == 0) return;
  grain = grain ? grain : 1;
  struct Body {
    std::remove_reference_t<F>& f;
    size_t n, grain;
  } body{f, n, grain};
  detail::run_chunks(
      n / grain + (n % grain != 0),
      [](void* p, size_t chunk) {
        Body& b = *static_cast<Body*>(p);
        const size_t begin = chunk * b.grain;
        b.f(begin, b.grain < b.n - begin ? begin + b.grain : b.n);
      },
      &body, context);
}

/// join(...join(join(init, map(chunk 0)), map(chunk 1))...) in chunk order: the same bytes for any number of threads.
template <class T, class Map, class Join>
T parallel_reduce(size_t n, size_t grain, T init, Map&& map, Join&& join, const Context* context = nullptr) {
  grain = grain ? grain : 1;
  const size_t chunks = n / grain + (n % grain != 0);
  auto parts = std::make_unique<T[]>(chunks);  // not std::vector: vector<bool> would race
  parallel_for(
      n, grain, [&](size_t begin, size_t end) { parts[begin / grain] = map(begin, end); }, context);
  for (size_t i = 0; i < chunks; ++i) init = join(std::move(init), std::move(parts[i]));
  return init;
}

/// Runs f and g at the same time where threads are free.
template <class F, class G>
void parallel_invoke(F&& f, G&& g) {
  parallel_for(2, 1, [&](size_t begin, size_t) {
    if (begin == 0) f();
    else g();
  });
}

/// Replaces counts by the sums of those before them and returns the total.
size_t exclusive_scan(std::vector<size_t>& counts);

}  // namespace sg
