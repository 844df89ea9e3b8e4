// SPDX-License-Identifier: Apache-2.0
// Sightglass for C++ programs: read or build data, run operations, make pictures. This header is all that is installed beside the library.
//
//   #include <sightglass/sightglass.h>
//   sg::Data flow = sg::read("carotid.vtk");
//   sg::Data lines = flow.run("streamlines", {{"min_speed", 0.05}, {"integrator", "rk4"}});
//   sg::Scene().show(lines, "lines", {{"field", "vectors"}}).camera({{"view", "front"}}).render(800, 600).write("flow.png");
//
// Values. Data, Array, Scene and Image are values: copying one is cheap (numbers are shared, never copied along), and Data never change:
//   what run() and with_...() return is new, and shares what stayed the same.
// Parameters. Operations, ways to show, camera and picture take parameters by name with typed values. `sightglass ops` lists the names,
//   `sightglass ops NAME` the parameters with units, ranges and choices; help() gives the same text.
// Throws. Error alone, where the mistake is made: run() has finished when it returns. Nothing is printed, ever.
// Threads. Values may be used from any number of threads; a Scene that is changed, from one at a time. Work runs on all cores, and results
//   are the same bytes for any number of them.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#define SIGHTGLASS_API __attribute__((visibility("default")))

namespace sightglass {

/// "0.1.0".
SIGHTGLASS_API std::string version();

/// Whatever goes wrong. what() reads "where: problem; hint (while A, while B)".
class SIGHTGLASS_API Error : public std::exception {
 public:
  /// Who has to act: the caller (usage), the owner of the file or the numbers (data), Sightglass (internal), nobody (cancelled).
  enum class Kind { usage, data, internal, cancelled };
  Error(Kind kind, std::string text, std::string problem, std::string where, std::string hint);
  ~Error() override;
  const char* what() const noexcept override { return text_.c_str(); }
  Kind kind() const noexcept { return kind_; }
  const std::string& problem() const noexcept { return problem_; }  ///< what is wrong
  const std::string& where() const noexcept { return where_; }      ///< operation and parameter, or the file
  const std::string& hint() const noexcept { return hint_; }        ///< what would be right

 private:
  Kind kind_;
  std::string text_, problem_, where_, hint_;
};

/// What a parameter is set to: a truth value, a number, a word, or a list of numbers or words; nothing = the operation chooses ("auto").
class Value {
 public:
  using Alternatives =
      std::variant<std::monostate, bool, int64_t, double, std::string, std::vector<int64_t>, std::vector<double>, std::vector<std::string>>;

  Value() = default;
  Value(const char* word) : held_(std::string(word)) {}
  Value(std::string word) : held_(std::move(word)) {}
  Value(std::string_view word) : held_(std::string(word)) {}
  template <class T>
  requires std::is_arithmetic_v<T> Value(T v) {
    if constexpr (std::is_same_v<T, bool>) held_ = v;
    else if constexpr (std::is_integral_v<T>) held_ = int64_t(v);
    else held_ = double(v);
  }
  Value(std::initializer_list<double> v) : held_(std::vector<double>(v)) {}
  Value(std::initializer_list<std::string_view> v) : held_(std::vector<std::string>(v.begin(), v.end())) {}
  Value(std::array<double, 3> v) : held_(std::vector<double>(v.begin(), v.end())) {}
  Value(std::vector<int64_t> v) : held_(std::move(v)) {}
  Value(std::vector<double> v) : held_(std::move(v)) {}
  Value(std::vector<std::string> v) : held_(std::move(v)) {}

  const Alternatives& alternatives() const { return held_; }

 private:
  Alternatives held_;
};

/// One parameter: {"values", {300, 400}}, {"integrator", "rk4"}, {"normals", true}.
struct Param {
  std::string name;
  Value value;
};
using Params = std::vector<Param>;

class Image;

/// Progress, messages and an end before the end, of the work it is given to. Copies are the same context. Once cancelled it stays so.
class SIGHTGLASS_API Context {
 public:
  Context();
  /// Called with 0 to 1 and what is being done, from one thread at a time; must not throw. Set before the work begins.
  void on_progress(std::function<void(double fraction, std::string_view doing)> f);
  /// Called with what a user should know: notes (warning = false) and warnings. The same rules.
  void on_message(std::function<void(bool warning, std::string_view text)> f);
  /// Called by render() with pictures by paths of light (picture: integrator) while they grow: one at once, then better ones, every second
  /// and then more rarely; not with the one that render() returns. The same rules.
  void on_picture(std::function<void(const Image&)> f);
  /// The work ends soon, with Error of kind cancelled. From any thread, and from a signal handler.
  void cancel() const noexcept;
  bool cancelled() const noexcept;

  struct State;
  State& state() const { return *state_; }

 private:
  std::shared_ptr<State> state_;
};

/// At most so many threads work; 0 = all cores.
SIGHTGLASS_API void set_threads(int count);
/// Arrays that are made from now on may hold so many bytes together, else Error; 0 = no limit.
SIGHTGLASS_API void set_memory_limit(size_t bytes);

using Vec3 = std::array<double, 3>;
struct Range {
  double lo, hi;  ///< lo > hi: there is no finite value
};
struct Box {
  Vec3 lo, hi;
};

/// Types of numbers in arrays.
enum class Type : uint8_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

template <class T>
constexpr Type type_of() {
  if constexpr (std::is_same_v<T, float>) return Type::f32;
  else if constexpr (std::is_same_v<T, double>) return Type::f64;
  else {
    static_assert(std::is_integral_v<T> && !std::is_same_v<T, bool>, "arrays hold whole numbers of 1 to 8 bytes, float and double");
    constexpr int place = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 2 : sizeof(T) == 4 ? 4 : 6;
    return Type(place + (std::is_signed_v<T> ? 1 : 0));
  }
}

/// `count` tuples of `components` numbers of one type, in memory that the library or the caller owns.
class SIGHTGLASS_API Array {
 public:
  Array();
  /// Takes the vector over; its size is a multiple of `components`.
  template <class T>
  Array(std::vector<T> numbers, int components = 1) {
    auto owner = std::make_shared<const std::vector<T>>(std::move(numbers));
    *this = wrap(std::span<const T>(*owner), components, owner);
  }
  /// Uses numbers of the caller's without a copy. They must not change, nor go away while anything that was made from them is there:
  /// `owner` is held until then (null: the caller sees to it). Tuples lie one after the other.
  template <class T>
  static Array wrap(std::span<const T> numbers, int components = 1, std::shared_ptr<const void> owner = nullptr) {
    return wrap_raw(numbers.data(), type_of<T>(), numbers.size_bytes(), components > 0 ? numbers.size() / size_t(components) : 0,
                    components, 0, std::move(owner));
  }
  /// The same for numbers inside of larger records: from one tuple to the next are `stride` bytes (a multiple of the number's size).
  template <class T>
  static Array wrap_strided(const T* first, size_t count, int components, size_t stride, std::shared_ptr<const void> owner = nullptr) {
    const size_t bytes = count ? (count - 1) * stride + size_t(components) * sizeof(T) : 0;
    return wrap_raw(first, type_of<T>(), bytes, count, components, stride, std::move(owner));
  }

  Type type() const;
  size_t count() const;
  int components() const;
  /// One number as double. For a few of them; as() and numbers() are for many.
  double get(size_t tuple, int component = 0) const;
  /// All numbers where they lie, tuple by tuple. Throws Error(usage) when T is not their type, or when they lie apart.
  template <class T>
  std::span<const T> as() const {
    return {static_cast<const T*>(raw(type_of<T>())), count() * size_t(components())};
  }
  /// All numbers as doubles, tuple by tuple: a copy.
  std::vector<double> numbers() const;

  struct Held;
  explicit Array(std::shared_ptr<const Held> held);
  const Held& held() const { return *held_; }

 private:
  static Array wrap_raw(const void* data, Type type, size_t bytes, size_t count, int components, size_t stride,
                        std::shared_ptr<const void> owner);
  const void* raw(Type type) const;
  std::shared_ptr<const Held> held_;
};

/// Where the values of a field are; `whole`: one thing about all of it.
enum class On : uint8_t { points, cells, whole };

struct Field {
  std::string name;
  On on = On::points;
  Array values;      ///< one tuple per point or cell
  std::string unit;  ///< "K", "m/s"; "" = not known
};

/// Types of cells, numbered as in VTK; nodes in VTK's order. Any other of VTK's numbers may be cast to it.
enum class Cell : uint8_t {
  vertex = 1,
  line = 3,
  poly_line = 4,
  triangle = 5,
  polygon = 7,
  quad = 9,
  tetra = 10,
  hexahedron = 12,
  wedge = 13,
  pyramid = 14,
  quadratic_triangle = 22,
  quadratic_tetra = 24,
  quadratic_hexahedron = 25,
  lagrange_tetra = 71,
  lagrange_hexahedron = 72
};

/// Lists of point numbers, one per cell.
struct Cells {
  Array ids;      ///< all lists one after the other; i32 and i64 are used where they lie
  Array offsets;  ///< where each list begins, and where the last one ends: one more than there are cells
  Array types;    ///< u8 (Cell), one per cell
  // Of polyhedra; empty where there are none.
  Array face_ids;      ///< the point numbers of all faces one after the other
  Array face_offsets;  ///< where each face begins: one more than there are faces
  Array cell_faces;    ///< where the faces of each cell begin: one more than there are cells
};

/// Point (i,j,k) lies at origin + spacing[0] i axes[0] + spacing[1] j axes[1] + spacing[2] k axes[2].
struct Placing {
  Vec3 spacing{1, 1, 1}, origin{0, 0, 0};
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< directions, of length 1
};

class SIGHTGLASS_API Image;

/// A mesh with its fields, a collection of named parts, or a table of columns.
class SIGHTGLASS_API Data {
 public:
  Data();  ///< Empty: whatever is asked of it throws Error(usage).

  /// "uniform", "rectilinear", "curvilinear", "unstructured", "surface", "points", "amr"; "collection", "table".
  std::string kind() const;
  /// One line: "uniform 256x256x94, 6160384 points, 1 field".
  std::string summary() const;
  /// What read(), source(), run() or at() said while they made it, one line each: what was chosen and why ("values=0.5, the middle of the
  /// range"), and warnings. None of data from memory.
  const std::vector<std::string>& notes() const;
  /// Of all parts together; 0 for tables.
  size_t point_count() const;
  size_t cell_count() const;
  Box bounds() const;

  /// In file order; of a table its columns (a column of words holds places in words(), -1 where there is none). Of a collection: see
  /// parts().
  std::vector<Field> fields() const;
  /// Points before cells before the whole. Throws Error(usage) with the nearest name.
  Field field(std::string_view name) const;
  /// Of the finite values, of all parts together. component -1: the only one, or the length of each tuple.
  Range range(std::string_view field, int component = -1) const;
  /// The words of a column of a table; none for numbers.
  std::vector<std::string> words(std::string_view column) const;

  /// Positions of all points of any mesh: f64, 3 components; the mesh's own numbers where it has them so.
  Array points() const;
  /// Points along x, y, z of a uniform, rectilinear or curvilinear grid (x fastest). Throws Error(usage) for others.
  std::array<size_t, 3> dims() const;
  /// Where a uniform grid lies. Throws Error(usage) for others.
  Placing placing() const;
  /// The coordinates along x, y and z of a uniform or rectilinear grid (of a uniform one along its own axes). Throws Error(usage) for
  /// others.
  std::array<Array, 3> coordinates() const;
  /// Of an unstructured mesh or a surface, whose cells stand in the order vertices, lines, polygons, strips. Throws Error(usage) for
  /// others.
  Cells cells() const;

  /// The time of what is at hand; none where the data do not say.
  std::optional<double> time() const;
  /// The times of the series that it comes from, ascending; empty where nothing above it has times.
  std::vector<double> times(const Context& context = {}) const;
  /// The same at another time: what lies above it runs again, on the step nearest to `time`.
  Data at(double time, const Context& context = {}) const;

  /// The datasets and tables of a collection in order, nested names joined by '/'; itself for anything else.
  std::vector<std::pair<std::string, Data>> parts() const;

  /// The same mesh with one more field, or another one of that name. Of single datasets.
  Data with_field(Field field) const;
  Data with_point_field(std::string name, Array values, std::string unit = {}) const;
  Data with_cell_field(std::string name, Array values, std::string unit = {}) const;

  /// Runs an operation; `others` are its further inputs. Of a time series that was read, operations that follow time (pathlines,
  /// streaklines) read the steps they need. Throws Error: unknown names with the nearest one, values out of range, meshes it cannot work
  /// on.
  Data run(std::string_view operation, const Params& params = {}, const Context& context = {}) const;
  Data run(std::string_view operation, const Params& params, const std::vector<Data>& others, const Context& context = {}) const;

  /// The same with a struct of sightglass/operations.h: run(sg::ops::Contour{.values = {0.5}}).
  template <class P>
  requires requires(const P& p) { P::operation_name, p.stated_params(); }
  Data run(const P& p, const Context& context = {}) const { return run(P::operation_name, p.stated_params(), context); }
  template <class P>
  requires requires(const P& p) { P::operation_name, p.stated_params(); }
  Data run(const P& p, const std::vector<Data>& others, const Context& context = {}) const {
    return run(P::operation_name, p.stated_params(), others, context);
  }

  /// The extension chooses the format. Parameters are those of the format (sightglass ops FORMAT):
  /// encoding, compression, binary, pieces, chunk. Nothing is ever half written.
  void write(const std::string& path, const Params& params = {}, const Context& context = {}) const;

  struct Held;
  explicit Data(std::shared_ptr<const Held> held);
  const std::shared_ptr<const Held>& held() const { return held_; }

 private:
  std::shared_ptr<const Held> held_;
};

/// Any file that `sightglass info` reads; of a series ("flow_*.vtu") one step. Parameters: `sightglass ops read` (fields, time, region,
/// ...).
SIGHTGLASS_API Data read(const std::string& path, const Params& params = {}, const Context& context = {});
/// The times of a series, ascending; empty for a file without time.
SIGHTGLASS_API std::vector<double> times(const std::string& path, const Context& context = {});
/// Data that are computed: "gyroid", "abc", ... (the sources of `sightglass ops`).
SIGHTGLASS_API Data source(std::string_view name, const Params& params = {}, const Context& context = {});
template <class P>
requires requires(const P& p) { P::operation_name, p.stated_params(); }
Data source(const P& p, const Context& context = {}) { return source(P::operation_name, p.stated_params(), context); }

// Meshes from memory. Arrays are used where they lie. Throws Error(data) for lists of ids that lead outside, and for sizes that differ.
/// Point (i,j,k) lies at origin + spacing * (i,j,k); x is fastest. A dimension of 1 makes it flat.
SIGHTGLASS_API Data uniform_grid(std::array<size_t, 3> dims, Vec3 spacing = {1, 1, 1}, Vec3 origin = {0, 0, 0});
/// The same turned: axes are made as long as 1, and may not lie in a plane.
SIGHTGLASS_API Data uniform_grid(std::array<size_t, 3> dims, const Placing& placing);
/// The coordinates along each axis, ascending or descending; f32 or f64.
SIGHTGLASS_API Data rectilinear_grid(Array x, Array y, Array z);
/// Points: f32 or f64, x y z of each, as 3 components or one after the other; x is fastest.
SIGHTGLASS_API Data curvilinear_grid(std::array<size_t, 3> dims, Array points);
SIGHTGLASS_API Data unstructured_mesh(Array points, Cells cells);
/// Cells of one type with a fixed number of points.
SIGHTGLASS_API Data unstructured_mesh(Array points, Cell type, Array ids);
SIGHTGLASS_API Data triangle_mesh(Array points, Array ids);
SIGHTGLASS_API Data polygon_mesh(Array points, Array ids, Array offsets);
SIGHTGLASS_API Data line_mesh(Array points, Array ids, Array offsets);
/// Cells of several kinds in one surface, numbered in this order; each kind as lists of point numbers and where each begins, or neither.
struct SurfaceCells {
  struct Lists {
    Array ids, offsets;
  };
  Lists vertices, lines, polygons, strips;
};
SIGHTGLASS_API Data surface_mesh(Array points, const SurfaceCells& cells);
SIGHTGLASS_API Data point_cloud(Array points);

/// Patches of one fineness: whole boxes of cells.
struct AmrLevel {
  /// Cells lo to hi, both in it, counted at this level from the origin of the grid.
  struct Patch {
    std::array<int64_t, 3> lo, hi;
  };
  Vec3 spacing;  ///< of its cells
  std::vector<Patch> patches;
};
/// Cell fields hold the cells of all patches one after the other (level by level, patch by patch, x fastest), point fields likewise. Each
/// level's spacing is a whole share of the one before; cells under finer patches count as refined.
SIGHTGLASS_API Data amr_grid(const std::vector<AmrLevel>& levels, Vec3 origin = {0, 0, 0});

/// Numbers, one per row; with `words` places in them (-1: none).
struct Column {
  std::string name;
  Array values;
  std::string unit;
  std::vector<std::string> words;
};
SIGHTGLASS_API Data table(const std::vector<Column>& columns);

/// Parts by name, in order; of any kind, collections too.
SIGHTGLASS_API Data collection(const std::vector<std::pair<std::string, Data>>& parts);

/// A time series that the program makes: `load` gives step 0, 1, ... when it is asked for, and the same each time; one step is held at a
/// time. It may be called from any thread, not from several at once by one operation. What it throws comes out of what asked for the step.
/// The data at hand are those of the first step. `times` ascend.
SIGHTGLASS_API Data series(std::vector<double> times, std::function<Data(size_t step)> load, const Context& context = {});

/// What a legend of a picture says.
struct Legend {
  struct Entry {
    double value;
    std::string name;              ///< "" where only the number is known
    std::array<uint8_t, 3> color;  ///< sRGB
  };
  std::string title, unit;
  std::string scale;  ///< how values are mapped to colours: "linear", "log" or "symlog"
  double low = 0, high = 1;
  std::vector<std::array<uint8_t, 3>> colors;      ///< sRGB, 256 evenly along the bar from `low` to `high`; none where there are entries
  std::vector<Entry> entries;                      ///< of labels and bands
  std::vector<std::pair<double, double>> opacity;  ///< of volumes: values and opacities, linear in between
};

/// Pixels: 8 bits, sRGB, rows from the top, tightly packed.
class SIGHTGLASS_API Image {
 public:
  int width() const;
  int height() const;
  int channels() const;  ///< 3, or 4 with a transparent background (straight alpha)
  std::span<const uint8_t> pixels() const;
  /// How far what is seen lies along the view, in units of the data, for each pixel; of volumes where half of the light is gone; infinity
  /// where nothing is. Empty for the pictures of a film.
  std::span<const float> depth() const;
  /// Which of what was shown is seen: 1 is that of the first show(), 0 nothing, legends or axes. Empty for the pictures of a film.
  std::span<const uint32_t> ids() const;
  /// Of pictures by paths of light the standard error of each pixel as displayed, as a share of full scale, before denoising; else empty.
  std::span<const float> error() const;
  /// What the legends say, each once. Empty without legends and for the pictures of a film.
  const std::vector<Legend>& legends() const;
  /// What was chosen and why, one line each.
  const std::vector<std::string>& notes() const;
  /// The pipeline that makes this picture again (`sightglass run`, `sightglass open`), as YAML. Numbers from memory are not in it: there it
  /// says what they were, and making it again is refused.
  std::string recipe() const;
  /// As .png (with the recipe, which `sightglass open` follows), .jpg or .webp.
  void write(const std::string& path) const;
  /// The bytes of a PNG file; paths in its recipe are relative to the working folder.
  std::vector<uint8_t> png() const;

  struct Held;
  explicit Image(std::shared_ptr<const Held> held);
  const Held& held() const { return *held_; }

 private:
  std::shared_ptr<const Held> held_;
};

/// One picture of a film.
struct Frame {
  Image image;
  size_t number, count;  ///< from 0
  double time;
};

/// A pipeline, as that of a file or of the recipe in a picture: steps that run when their results are needed, and results that are kept up
/// to a limit, so that after a change only what lies below it runs again. A value; from one thread at a time where it is changed.
class SIGHTGLASS_API Pipeline {
 public:
  /// One step: its name, what it does ("read", a source, an operation) and what is stated of it, as text.
  struct Step {
    std::string name, operation;
    std::vector<std::pair<std::string, std::string>> stated;
    std::vector<std::string> from;
  };
  /// Of YAML as `sightglass run` takes it. Throws one Error(usage) with all mistakes.
  static Pipeline parse(std::string_view yaml);
  /// From a file; relative paths in it begin at its folder.
  static Pipeline read(const std::string& path);
  /// The recipe in a picture that Sightglass made. It is data from outside: it may read only below the folder of the picture and the
  /// working folder, and write nothing (Error(usage) names what is in the way). `changed` receives the inputs that are not what they were.
  static Pipeline open(const std::string& picture, std::vector<std::string>* changed = nullptr);
  /// The steps that the data came from. Numbers from memory are held.
  explicit Pipeline(const Data& data);

  std::vector<Step> steps() const;
  /// Of that step from now on; empty values are taken back. Throws Error(usage): unknown names with the nearest one, values out of range.
  Pipeline& set(std::string_view step, const Params& params);
  /// Of a step; "" the last one.
  Data result(std::string_view step = {}, const Context& context = {}) const;
  /// What the pipeline shows; where it shows nothing, what suits its last results.
  Image render(int width = 0, int height = 0, const Context& context = {}) const;  ///< 0: as it states, else 1280x720
  /// That picture as a page, as Scene::page().
  std::string page(const Params& params = {}, int width = 0, int height = 0, const Context& context = {}) const;
  /// The plan of the last result as a table: what runs, what is cached, with sizes and times expected.
  std::string explain() const;
  /// As YAML. Numbers from memory are named only.
  std::string text() const;
  void write(const std::string& path) const;
  /// How many bytes of results are kept beyond their use; 512 MB at first.
  void set_cache_limit(size_t bytes);

 private:
  struct State;
  explicit Pipeline(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

/// What is to be seen, and from where. Parameters are checked at once; calls chain. camera(), picture() and film() take structs of
/// sightglass/operations.h, too: camera(sg::settings::Camera{.view = "front"}).
class SIGHTGLASS_API Scene {
 public:
  Scene();
  /// As the data suggest.
  Scene& show(const Data& data);
  /// "surface", "volume", "lines", "points", "labels", "glyphs" or "outline" (`sightglass ops surface`); "auto" chooses, and takes the
  /// parameters of colours: field, map, range, scale, ...
  Scene& show(const Data& data, std::string_view way, const Params& params = {});
  /// The same with a struct of sightglass/operations.h: show(data, sg::shows::Surface{.opacity = 0.5}).
  template <class P>
  requires requires(const P& p) { P::way_name, p.stated_params(); }
  Scene& show(const Data& data, const P& p) { return show(data, P::way_name, p.stated_params()); }
  /// `sightglass ops camera`: view, direction, azimuth, zoom, ... What is not said follows from the data.
  Scene& camera(const Params& params);
  /// `sightglass ops picture`: title, background, legend, axes, triad, samples, ...
  Scene& picture(const Params& params);
  Image render(int width = 1280, int height = 720, const Context& context = {}) const;

  /// A film: a picture per time, all with the looks and colours of one. What comes from a series, or a source with a time, and states none
  /// moves; what lies between runs again each time. Camera and picture take the time where a value holds "{t}": {"azimuth", "{t}"}.
  /// `output`: "out_{n}.png" (numbered pictures, with their recipes), "film.webm", "film.gif", or "film.mp4" where ffmpeg is installed.
  /// Parameters: `sightglass ops film`: times (a list, or text; default: all of the series), fps. Returns the times. Throws Error(usage)
  /// where nothing has times.
  std::vector<double> film(const std::string& output, const Params& params = {}, int width = 1280, int height = 720,
                           const Context& context = {}) const;
  /// The same pictures for the program itself, one after the other, from the calling thread. Parameters: `times`. What `take` throws ends
  /// the film and comes out of this.
  std::vector<double> frames(const std::function<void(const Frame&)>& take, const Params& params = {}, int width = 1280, int height = 720,
                             const Context& context = {}) const;
  /// A page that turns in any browser: the text of one HTML file, which needs no network. Parameters: `sightglass ops page`; and `times` as
  /// of film(), for a page with time steps. Throws Error(usage) where the stated size is too small.
  std::string page(const Params& params = {}, int width = 1280, int height = 720, const Context& context = {}) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

/// A film of pictures that the program makes one after the other: of a simulation as it goes on, of a camera on its way. Copies are the
/// same film; from one thread at a time.
class SIGHTGLASS_API Film {
 public:
  /// As Scene::film(); parameters: fps.
  explicit Film(const std::string& output, const Params& params = {});
  /// Of a film all have one size. A numbered picture is there at once, with its recipe.
  void add(const Image& image);
  /// A film is there when this returns; without it there is none.
  void finish();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// What `sightglass ops NAME` prints: an operation, its parameters, units, ranges and choices. "": all operations.
SIGHTGLASS_API std::string help(std::string_view operation = {});
/// All of it as `sightglass ops --json` prints it: sources, operations, ways to show, readers, writers, camera, picture and film with JSON
/// Schemas of their parameters.
SIGHTGLASS_API std::string catalog_json();

}  // namespace sightglass

#ifndef SIGHTGLASS_NO_SHORT_NAME
namespace sg = sightglass;
#endif
