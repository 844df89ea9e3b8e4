// SPDX-License-Identifier: Apache-2.0
#include "io/isolated.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {

constexpr uint64_t finished = 0x5349474854474c53;  // written last: the child got through
constexpr size_t front = 16;                       // bytes before the description: finished, its length

// The description of the result: numbers and texts one after the other; arrays lie behind it at multiples of 64 bytes.
struct Writer {
  std::string text;
  std::vector<Array> arrays;
  size_t array_bytes = 0;

  template <class T>
  void number(T v) {
    text.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  void string(std::string_view s) {
    number(uint64_t(s.size()));
    text += s;
  }
  void array(const Array& a) {
    const Array p = a.made_packed();
    number(uint8_t(p.type())), number(uint64_t(p.count())), number(int32_t(p.components())), number(uint64_t(array_bytes));
    arrays.push_back(p);
    array_bytes += (p.bytes() + 63) / 64 * 64;
  }
  void dataset(const Dataset& d) {
    if (const auto* g = d.as<UniformGrid>()) {
      number('u');
      number(*g);
    } else if (const auto* c = d.as<PointCloud>()) {
      number('p');
      number(c->points.origin);
      array(c->points.xyz);
    } else {
      fail_internal("only uniform grids and point clouds come out of a reading process");
    }
    number(uint64_t(d.fields().size()));
    for (const Field& f : d.fields()) {
      string(f.name), string(f.unit);
      number(uint8_t(f.association)), number(uint8_t(f.role));
      array(f.array);
    }
    number(uint64_t(d.notes().size()));
    for (const auto& [k, v] : d.notes()) string(k), string(v);
  }
};
static_assert(std::is_trivially_copyable_v<UniformGrid>);

struct Reader {
  Buffer file;  ///< the child's whole file
  size_t at = front, end = 0, arrays = 0;
  const std::string& path;

  void need(size_t n) const {
    if (n > end - at) fail_data("is damaged: the process that reads it left nonsense", path);
  }
  template <class T>
  T number() {
    need(sizeof(T));
    T v;
    std::memcpy(&v, file.data + at, sizeof v);
    at += sizeof v;
    return v;
  }
  std::string string() {
    const auto n = number<uint64_t>();
    need(n);
    std::string s(reinterpret_cast<const char*>(file.data) + at, n);
    at += n;
    return s;
  }
  Array array() {
    const auto type = number<uint8_t>();
    const auto count = number<uint64_t>();
    const auto components = number<int32_t>();
    const auto offset = number<uint64_t>();
    if (type > uint8_t(ElementType::f64) || components < 1 || offset > file.size - arrays) need(SIZE_MAX);
    return Array({file.owner, file.data + arrays + offset, file.size - arrays - offset}, ElementType(type), count, components);
  }
  DatasetPtr dataset() {
    DatasetParts p;
    if (number<char>() == 'u') {
      p.mesh = number<UniformGrid>();
    } else {
      PointCloud c;
      c.points.origin = number<Vec3>();
      c.points.xyz = array();
      p.mesh = c;
    }
    for (auto n = number<uint64_t>(); n > 0; --n) {
      Field f;
      f.name = string(), f.unit = string();
      f.association = Association(number<uint8_t>()), f.role = Role(number<uint8_t>());
      f.array = array();
      p.fields.add(std::move(f));
    }
    for (auto n = number<uint64_t>(); n > 0; --n) {
      std::string key = string();
      p.notes.emplace_back(std::move(key), string());
    }
    return make_dataset(std::move(p));
  }
};

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

void limit_memory(size_t memory) {
  size_t pages = 0;
  if (std::FILE* f = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(f, "%zu", &pages) != 1) pages = 0;
    std::fclose(f);
  }
  const rlim_t bytes = rlim_t(pages) * rlim_t(::sysconf(_SC_PAGESIZE)) + memory;
  const rlimit limit{bytes, bytes}, no_core{0, 0};
  if (pages > 0) ::setrlimit(RLIMIT_AS, &limit);
  ::setrlimit(RLIMIT_CORE, &no_core);
}

// What the child does; never returns to the caller's code.
[[noreturn]] void work(int fd, const std::function<Data(Context&)>& read, size_t file_bytes, size_t memory, size_t memory_limit) {
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) ::signal(signal, SIG_DFL);
  limit_memory(memory);
  const rlim_t seconds = 2 + (rlim_t(memory) >> 29) + (rlim_t(file_bytes) >> 22);  // a damaged file can send a library round and round
  const struct rlimit limit { seconds, seconds };
  ::setrlimit(RLIMIT_CPU, &limit);
  if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) ::dup2(nowhere, 1), ::dup2(nowhere, 2);
  auto* w = new Writer;  // nothing is destroyed here: destructors of libraries may wait for threads that this process lacks
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
    if (auto* d = std::get_if<DatasetPtr>(data)) {
      w->number('d');
      w->dataset(**d);
    } else {
      const auto& parts = std::get<CollectionPtr>(*data)->parts;
      w->number('c');
      w->number(uint64_t(parts.size()));
      for (const auto& p : parts) w->string(p.name), w->dataset(*std::get<DatasetPtr>(p.data));
    }
    tell_logs();
  } catch (const Error& e) {
    fail(e.kind(), e.problem(), e.where(), e.hint());
  } catch (const std::bad_alloc&) {
    fail(ErrorKind::data, "asks for more memory than is allowed", "", "");
  } catch (const std::exception& e) {
    fail(ErrorKind::data, e.what(), "", "");
  } catch (...) {
    ::_exit(1);
  }
  const uint64_t head[2] = {0, w->text.size()};
  bool good = write_all(fd, head, sizeof head) && write_all(fd, w->text.data(), w->text.size());
  size_t at = (front + w->text.size() + 63) / 64 * 64;
  for (const Array& a : w->arrays) {
    good = good && ::lseek(fd, off_t(at), SEEK_SET) >= 0 && write_all(fd, a.raw(), a.bytes());
    at += (a.bytes() + 63) / 64 * 64;
  }
  good = good && ::ftruncate(fd, off_t(at)) == 0 && ::lseek(fd, 0, SEEK_SET) == 0 && write_all(fd, &finished, sizeof finished);
  ::_exit(good ? 0 : 1);
}

}  // namespace

Data read_isolated(const std::string& path, const std::function<Data(Context&)>& read, size_t memory, Context& context) {
  struct stat file {};
  const size_t file_bytes = ::stat(path.c_str(), &file) == 0 ? size_t(file.st_size) : 0;
  const int fd = ::memfd_create("sightglass", MFD_CLOEXEC);
  if (fd < 0) fail_data("no memory can be shared with a process that reads it", path);
  const std::shared_ptr<const void> closer(nullptr, [fd](const void*) { ::close(fd); });
  const pid_t child = ::fork();
  if (child < 0) fail_data("no process for reading can be started", path);
  if (child == 0) work(fd, read, file_bytes, memory, context.memory_limit);
  for (int status = 0;;) {
    const pid_t r = ::waitpid(child, &status, WNOHANG);
    if (r != 0 && !(r < 0 && errno == EINTR)) break;
    if (context.cancelled()) ::kill(child, SIGKILL);
    ::usleep(500);
  }
  context.check();
  struct stat s {};
  uint64_t head[2]{};
  if (::fstat(fd, &s) != 0 || ::pread(fd, head, sizeof head, 0) != ssize_t(sizeof head) || head[0] != finished ||
      head[1] > size_t(s.st_size) - front)
    fail_data("is damaged: the library that reads it gave up", path);
  const auto size = size_t(s.st_size);
  void* map = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, fd, 0);
  if (map == MAP_FAILED) fail_data("there is not enough memory for it", path);
  Reader in{{std::shared_ptr<const void>(map, [size](const void* m) { ::munmap(const_cast<void*>(m), size); }),
             static_cast<const std::byte*>(map), size},
            front,
            front + head[1],
            std::min(size, (front + head[1] + 63) / 64 * 64),
            path};
  const char kind = in.number<char>();
  std::optional<Error> error;
  Data result;
  if (kind == 'e') {
    const auto what = ErrorKind(in.number<uint8_t>());
    const std::string problem = in.string(), where = in.string(), hint = in.string();
    error.emplace(what, problem, where.empty() ? path : where, hint);
  } else if (kind == 'd') {
    result = in.dataset();
  } else {
    Collection c;
    for (auto n = in.number<uint64_t>(); n > 0; --n) {
      std::string name = in.string();
      c.parts.push_back({std::move(name), in.dataset()});
    }
    result = std::make_shared<const Collection>(std::move(c));
  }
  for (auto n = in.number<uint64_t>(); n > 0; --n) {
    const auto level = LogLevel(in.number<uint8_t>());
    context.log(level, in.string());
  }
  if (error) throw *error;
  return result;
}

void try_in_child(const std::string& path, std::string_view library, const std::function<void()>& read) {
  struct stat st {};
  const rlim_t seconds = 60 + (::stat(path.c_str(), &st) == 0 ? rlim_t(st.st_size) >> 22 : 0);
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) fail_data(fmt::format("no process can be started to try it in: {}", std::strerror(errno)), path);
  if (child == 0) {
    set_thread_count(1);
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM, SIGXCPU}) ::signal(signal, SIG_DFL);
    const struct rlimit limit { seconds, seconds }, no_core{0, 0};
    ::setrlimit(RLIMIT_CPU, &limit);
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::alarm(unsigned(std::min<rlim_t>(4 * seconds, 86400)));  // also when it waits for what never comes
    if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) ::dup2(nowhere, 2), ::dup2(nowhere, 1);
    try {
      read();
    } catch (...) {  // said again, and heard, in the parent
    }
    ::_exit(0);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    fail_data(fmt::format("the {} library does not survive reading it", library), path, "the file is damaged");
}

}  // namespace sg
