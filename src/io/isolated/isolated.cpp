// SPDX-License-Identifier: Apache-2.0
#include "io/isolated/isolated.h"

#include <fmt/core.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/error.h"
#include "data/memory/memory_budget.h"
#include "io/isolated/carried.h"

namespace sg {

namespace {

constexpr uint64_t finished = 0x5349474854474c53;  // written last: the child got through
constexpr size_t front = 16;                       // bytes before the description: finished, its length
enum : int { end_good = 0, end_bad = 1, end_no_memory = 3 };

bool write_all(int fd, const void* data, size_t n) {
  const char* p = static_cast<const char*>(data);
  while (n > 0) {
    const ssize_t done = ::write(fd, p, std::min<size_t>(n, size_t(1) << 30));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    p += done, n -= size_t(done);
  }
  return true;
}

bool write_result(int fd, const CarryWriter& w) {
  const uint64_t head[2] = {0, w.text.size()};
  bool good = write_all(fd, head, sizeof head) && write_all(fd, w.text.data(), w.text.size());
  size_t at = (front + w.text.size() + 63) / 64 * 64;
  for (const Array& a : w.arrays) {
    good = good && ::lseek(fd, off_t(at), SEEK_SET) >= 0 && write_all(fd, a.raw(), a.bytes());
    at += (a.bytes() + 63) / 64 * 64;
  }
  return good && ::ftruncate(fd, off_t(at)) == 0 && ::lseek(fd, 0, SEEK_SET) == 0 && write_all(fd, &finished, sizeof finished);
}

// What the child does; never returns to the caller's code.
[[noreturn]] void work(int fd, const std::function<Data(Context&)>& read, size_t memory_limit) {
  if (::ftruncate(fd, 0) != 0 || ::lseek(fd, 0, SEEK_SET) != 0) ::_exit(end_bad);  // what another start has left
  auto* w = new CarryWriter;  // nothing is destroyed here: destructors of libraries may wait for threads that this process lacks
  auto* logs = new std::vector<std::pair<LogLevel, std::string>>;
  auto* c = new Context;
  c->memory_limit = memory_limit;
  c->on_log = [logs](LogLevel l, std::string_view s) { logs->emplace_back(l, s); };
  auto tell_logs = [&] {
    w->number(uint64_t(logs->size()));
    for (const auto& [l, s] : *logs) w->number(uint8_t(l)), w->string(s);
  };
  auto fail = [&](ErrorKind kind, const std::string& problem, const std::string& where, const std::string& hint) {
    *w = {};
    w->number('e');
    w->number(uint8_t(kind));
    w->string(problem), w->string(where), w->string(hint);
    tell_logs();
  };
  try {
    auto* data = new Data(read(*c));
    w->number('d');
    w->data(*data);
    tell_logs();
  } catch (const Error& e) {
    fail(e.kind(), e.problem(), e.where(), e.hint());
  } catch (const std::bad_alloc&) {
    ::_exit(end_no_memory);
  } catch (const std::exception& e) {
    fail(ErrorKind::data, e.what(), "", "");
  } catch (...) {
    ::_exit(end_bad);
  }
  ::_exit(write_result(fd, *w) ? end_good : end_bad);
}

// Whether a file that a library reads (unmapped, so that no watch sees it) stays the same meanwhile.
struct FileState {
  explicit FileState(const std::string& p) : path(p), known(::stat(p.c_str(), &st) == 0 && S_ISREG(st.st_mode)) {}
  void check() const {
    struct stat now {};
    if (!known || ::stat(path.c_str(), &now) != 0 || now.st_ino != st.st_ino || now.st_dev != st.st_dev) return;
    if (now.st_size != st.st_size || now.st_mtim.tv_sec != st.st_mtim.tv_sec || now.st_mtim.tv_nsec != st.st_mtim.tv_nsec)
      fail_data("the file changed while it was being read", path, "read it again once it has been written completely");
  }
  const std::string& path;
  struct stat st {};
  bool known;
};

// What lies in the shared memory.
Data take_result(int fd, const std::string& path, Context& context) {
  struct stat s {};
  uint64_t head[2]{};
  if (::fstat(fd, &s) != 0 || ::pread(fd, head, sizeof head, 0) != ssize_t(sizeof head) || head[0] != finished ||
      head[1] > size_t(s.st_size) - front)
    fail_data("is damaged: the library that reads it failed", path);
  const auto size = size_t(s.st_size);
  detail::claim_memory(size);
  void* map = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, fd, 0);
  if (map == MAP_FAILED) detail::return_memory(size), fail_data("there is not enough memory for it", path);
  const auto unmap = [size](const void* m) {
    ::munmap(const_cast<void*>(m), size);
    detail::return_memory(size);
  };
  const Buffer bytes{std::shared_ptr<const void>(map, unmap), static_cast<const std::byte*>(map), size};
  CarryReader in(bytes, front, front + head[1], std::min(size, (front + head[1] + 63) / 64 * 64), path);
  const char kind = in.number<char>();
  std::optional<Error> error;
  Data result;
  if (kind == 'e') {
    const auto what = ErrorKind(in.number<uint8_t>());
    const std::string problem = in.string(), where = in.string(), hint = in.string();
    error.emplace(what, problem, where.empty() ? path : where, hint);
  } else {
    result = in.data();
  }
  for (auto n = in.number<uint64_t>(); n > 0; --n) {
    const auto level = LogLevel(in.number<uint8_t>());
    context.log(level, in.string());
  }
  if (error) throw *error;
  return result;
}

}  // namespace

Data read_isolated(const std::string& path, const ChildLimits& limits, const std::function<Data(Context&)>& read, Context& context) {
  const FileState state(path);
  const int fd = ::memfd_create("sightglass", MFD_CLOEXEC);
  if (fd < 0) fail_data("cannot share memory with a process that reads it", path);
  const std::shared_ptr<const void> closer(nullptr, [fd](const void*) { ::close(fd); });
  const int status = run_child(limits, path, context, [&] { work(fd, read, context.memory_limit); });
  state.check();
  if (WIFEXITED(status) && WEXITSTATUS(status) == end_no_memory) fail_child_memory(limits, path);
  return take_result(fd, path, context);
}

Data read_isolated(const std::string& path, const std::function<Data(Context&)>& read, Context& context) {
  return read_isolated(path, reading_limits(bytes_at(path)), read, context);
}

std::vector<double> times_isolated(const std::string& path, const std::function<std::vector<double>(Context&)>& read, Context& context) {
  const Data column = read_isolated(
      path,
      [&](Context& c) -> Data {
        auto t = std::make_shared<Table>();
        t->columns.push_back({"time", Association::whole, Array::from_vector(read(c)), "", Role::none});
        return TablePtr(t);
      },
      context);
  const auto* table = std::get_if<TablePtr>(&column);
  if (!table || (*table)->columns.size() != 1 || (*table)->columns[0].array.type() != ElementType::f64)
    fail_data("is damaged: the process that reads it returned invalid data", path);
  const Array& a = (*table)->columns[0].array;
  std::vector<double> times(a.count());
  for (size_t i = 0; i < times.size(); ++i) times[i] = a.get(i);
  return times;
}

void try_in_child(const std::string& path, std::string_view library, const std::function<void()>& read) {
  const ChildLimits limits = reading_limits(bytes_at(path));
  const int status = run_child(limits, path, Context(), [&] {
    try {
      read();
    } catch (const std::bad_alloc&) {
      ::_exit(end_no_memory);
    } catch (...) {  // reported again in the parent
    }
    ::_exit(end_good);
  });
  if (WIFEXITED(status) && WEXITSTATUS(status) == end_no_memory) fail_child_memory(limits, path);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != end_good)
    fail_data(fmt::format("the {} library crashed while reading it", library), path, "the file is damaged");
}

}  // namespace sg
