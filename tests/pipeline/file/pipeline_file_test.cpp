// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file/pipeline_file.h"

#include <cstring>

#include "base/file/file.h"
#include "base/random.h"
#include "base/text/text.h"
#include "pipeline/operation/test_operations.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using Words = std::vector<std::string>;

namespace {

const char* const example =
    "sightglass: 1\n"
    "steps:\n"
    "  head:  {read: FullHead.mhd}\n"
    "  bone:  {contour: {values: [1150, -0.5e3], normals: }, from: head}   # a note\n"
    "  \"two words\": {append: , from: [head, bone]}\n"
    "show:\n"
    "  - {surface: {color: \"0.9,0.85,0.8\"}, of: bone}\n"
    "  - outline\n"
    "picture: {size: 1280x720, camera: {direction: [1, 0.5, 0.3], zoom: 2}, output: out.png}\n";

std::string error_of(const std::string& yaml) {
  return test::error_of([&] { parse_pipeline(yaml, "p.yaml"); });
}

bool has(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return true;
  MESSAGE(text);
  return false;
}

GraphOptions test_options() {
  test::reset_runs();
  GraphOptions o;
  o.operations = test::counted_operations();
  o.read = [](const std::string& path, const ReadOptions& r, const Request&, Context&) -> Data {
    CHECK(path == test::temp_folder() + "in.raw");
    CHECK(r.raw_dims[0] == (r.raw_type.empty() ? 0 : 4));
    return test::line_of(4);
  };
  return o;
}

}  // namespace

TEST_CASE("pipeline file: the parts become words") {
  const PipelineFile f = parse_pipeline(example, "p.yaml");
  REQUIRE(f.steps.size() == 3);
  CHECK(f.steps[0] == PipelineFile::Step{"head", "read", {"path=FullHead.mhd"}, {}, 0});
  CHECK(f.steps[1] == PipelineFile::Step{"bone", "contour", {"values=1150,-0.5e3", "normals"}, {"head"}, 0});
  CHECK(f.steps[2] == PipelineFile::Step{"two words", "append", {}, {"head", "bone"}, 0});
  CHECK(f.steps[1].line == 4);
  REQUIRE(f.show.size() == 2);
  CHECK(f.show[0] == PipelineFile::Show{"surface", {"color=0.9,0.85,0.8"}, "bone", 0});
  CHECK(f.show[1] == PipelineFile::Show{"outline", {}, "", 0});
  CHECK(f.show[1].line == 8);
  CHECK(f.picture == Words{"size=1280x720", "camera.direction=1,0.5,0.3", "camera.zoom=2", "output=out.png"});
  CHECK(words_under(f.picture, "camera") == Words{"direction=1,0.5,0.3", "zoom=2"});
  CHECK(*word_value(f.picture, "size") == "1280x720");
  CHECK_FALSE(word_value(f.picture, "siz"));
  CHECK(f.origin == "p.yaml");
}

TEST_CASE("pipeline file: emitting gives stable text that reads back to the same") {
  const PipelineFile f = parse_pipeline(example);
  const std::string text = emit_pipeline(f);
  CHECK(text ==
        "sightglass: 1\n"
        "steps:\n"
        "  head: {read: FullHead.mhd}\n"
        "  bone: {contour: {values: [1150, -0.5e3], normals:}, from: head}\n"
        "  \"two words\": {append:, from: [head, bone]}\n"
        "show:\n"
        "  - {surface: {color: [0.9, 0.85, 0.8]}, of: bone}\n"
        "  - {outline:}\n"
        "picture: {size: 1280x720, camera: {direction: [1, 0.5, 0.3], zoom: 2}, output: out.png}\n");
  CHECK(parse_pipeline(text) == f);
  CHECK(emit_pipeline(parse_pipeline(text)) == text);
}

TEST_CASE("pipeline file: any words survive the way out and back") {
  PipelineFile f;
  const Words odd{"",
                  "null",
                  "~",
                  "true",
                  "a: b",
                  "#x",
                  "[1,2]",
                  "{a}",
                  "1,2,",
                  ",1",
                  "1, 2",
                  " lead",
                  "trail ",
                  "\"q\"",
                  "'",
                  "\\n",
                  "new\nline",
                  "tab\t",
                  "&a",
                  "*a",
                  "!t",
                  "---",
                  "...",
                  "- x",
                  "-",
                  "?",
                  "a=b",
                  "50%",
                  "C:\\x",
                  "\x01\x7f",
                  "\xc3\xa9\xc2\x85",
                  "\xe2\x80\xa8",
                  "\xef\xbb\xbf",
                  "\xf0\x9f\x94\xad",
                  "0.1,1e-300,inf",
                  "1e400,2",
                  "<<",
                  "=",
                  "@x",
                  "`x",
                  "|",
                  ">",
                  "%x",
                  "null,1",
                  std::string("a\0b", 3)};
  for (size_t i = 0; i < odd.size(); ++i) {
    PipelineFile::Step s{"s" + std::to_string(i), "scale", {"key=" + odd[i], "bare"}, {}, 0};
    if (!odd[i].empty()) s.from = {odd[i], "x"}, s.name = odd[i];
    f.steps.push_back(s);
    f.show.push_back({"surface", {"k=" + odd[i]}, odd[i], 0});
  }
  f.steps.push_back({"raw", "read", {"path=a b.raw", "dims=1,2,3", "type=u8"}, {}, 0});
  f.picture = {"output=x", "camera.a=1", "size=2", "camera.b=2", "camera=3,4", "axes.x", "axes.y=", "legend"};
  for (const std::string& text : {emit_pipeline(f)}) {
    const PipelineFile back = parse_pipeline(text);
    REQUIRE(back.steps.size() == f.steps.size());
    for (size_t i = 0; i < f.steps.size(); ++i) CHECK_MESSAGE(back.steps[i] == f.steps[i], text);
    for (size_t i = 0; i < f.show.size(); ++i) CHECK_MESSAGE(back.show[i] == f.show[i], f.show[i].of);
    CHECK(back.picture == f.picture);
  }
}

TEST_CASE("pipeline file: doubles written exactly come back as the same doubles") {
  PipelineFile f;
  for (uint64_t i = 0; i < 200; ++i) {
    double v;
    const uint64_t bits = random_bits(7, i);
    std::memcpy(&v, &bits, 8);
    if (!std::isfinite(v)) continue;
    f.steps.push_back(
        {"s" + std::to_string(i), "scale", {"by=" + exact_number(v), "list=" + exact_number(v) + "," + exact_number(-v)}, {}, 0});
  }
  const PipelineFile back = parse_pipeline(emit_pipeline(f));
  CHECK(back == f);
}

TEST_CASE("pipeline file: what cannot be written is refused") {
  PipelineFile f;
  CHECK(has(error_of("sightglass: 1\nsteps: {a: {read: \xff}}"), "p.yaml:2: is not UTF-8 text"));
  f.steps = {{"a", "scale", {"=3"}, {}, 0}};
  CHECK(has(test::error_of([&] { emit_pipeline(f); }), "without a name"));
}

TEST_CASE("property: no name, path or title adds structure to a pipeline file: any bytes survive emit and parse") {
  constexpr std::string_view pieces[] = {"save: x",
                                         "\n",
                                         "\n  - {volume: {save: p}}",
                                         "}}",
                                         "]",
                                         "{",
                                         "[",
                                         ", ",
                                         ": ",
                                         "#",
                                         " #",
                                         "\"",
                                         "'",
                                         "\\",
                                         "\\x0a",
                                         "&a",
                                         "*a",
                                         "!!str",
                                         "|",
                                         ">",
                                         "%",
                                         "@",
                                         "`",
                                         "- ",
                                         "---",
                                         "...",
                                         "~",
                                         "null",
                                         "=",
                                         "\t",
                                         "\r",
                                         "\x1b[2J",
                                         "\xff",
                                         "\xc0\x80",
                                         "\xed\xa0\x80",
                                         "\xee\xbe\x80",
                                         "\xe2\x80\xa8",
                                         "\xc2\x85",
                                         "\xef\xbb\xbf",
                                         "\xef\xbf\xbf",
                                         " "};
  for (uint64_t seed : test::property_seeds(300)) {
    CAPTURE(seed);
    test::Random random(seed);
    const auto nasty = [&](bool key) {
      std::string s;
      for (int n = random.whole(key, 6); n > 0; --n) {
        if (random.chance(0.2)) s += char(random.whole(0, 255));
        else if (random.chance(0.2)) s += random.one_of({"1", "2.5", ",", "nan", "-3"});
        else s += pieces[size_t(random.whole(0, int(std::size(pieces)) - 1))];
      }
      if (key) std::erase(s, '='), std::erase(s, '.'), s += "k";
      return s;
    };
    PipelineFile f;
    f.steps = {{nasty(true), "read", {"path=" + nasty(false)}, {}, 0},
               {nasty(true) + "2", "scale", {nasty(true) + "=" + nasty(false)}, {}, 0}};
    f.steps[1].from = {f.steps[0].name};
    f.show = {{"volume", {"field=" + nasty(false), nasty(true)}, nasty(true)}};
    f.picture = {"title=" + nasty(false), "camera." + nasty(true) + "=" + nasty(false)};
    const std::string text = emit_pipeline(f);
    CAPTURE(text);
    for (const char c : text) REQUIRE((c == '\n' || static_cast<unsigned char>(c) >= 0x20));
    PipelineVocabulary any;
    any.picture.clear(), any.show.clear();
    CHECK(parse_pipeline(text, {}, any) == f);
  }
}

TEST_CASE("pipeline file: of words with one key the last is written") {
  PipelineFile f;
  f.steps = {{"a", "scale", {"by=1", "mode=plain", "by=2"}, {}, 0}};
  f.picture = {"camera.a=1", "size=2", "camera.a=3"};
  const PipelineFile back = parse_pipeline(emit_pipeline(f));
  CHECK(back.steps[0].words == Words{"mode=plain", "by=2"});
  CHECK(back.picture == Words{"size=2", "camera.a=3"});
  CHECK(has(error_of("sightglass: 1\nsteps: {a: {ramp: }}\npicture: {camera: {a: 1},\n camera.a: 2}"),
            "p.yaml:4: picture: the key 'camera.a' appears twice"));
  CHECK(has(error_of("sightglass: 1\nsteps: {a: {ramp: }}\npicture: {camera: {a.b: 1}}"),
            "p.yaml:3: picture camera: 'a.b' is not a valid name"));
}

TEST_CASE("pipeline file: every mistake of form is told with its line, all at once") {
  const std::string text = error_of(
      "sightglass: 2\n"                                // 1
      "stpes: {}\n"                                    // 2
      "steps:\n"                                       // 3
      "  a: read\n"                                    // 4
      "  b: {contour: {values: [1]}, form: a}\n"       // 5
      "  c: {}\n"                                      // 6
      "  d: {contour: [1]}\n"                          // 7
      "  e: {contour: {values: {x: 1}}}\n"             // 8
      "  f: {contour: {values: [[1]]}}\n"              // 9
      "  g: {contour: {words: ['a,b']}}\n"             // 10
      "  h: {contour: , from: {x: 1}}\n"               // 11
      "  i: {read: [[1]]}\n"                           // 12
      "  i: {read: x}\n"                               // 13
      "  j: {contour: {a: 1, a: 2}}\n"                 // 14
      "  k: {contour: {a=b: 1}}\n"                     // 15
      "show:\n"                                        // 16
      "  - {surfcae: , of: a}\n"                       // 17
      "  - {of: a}\n"                                  // 18
      "  - {surface: , of: [a]}\n"                     // 19
      "  - [surface]\n"                                // 20
      "picture: {sise: 1x1, camera: {a: {b: 1}}}\n");  // 21
  for (const char* part : {"20 errors:",
                           "p.yaml:1: sightglass: '2' is not a version",
                           "p.yaml:2: unknown key 'stpes'; did you mean 'steps'?",
                           "p.yaml:4: step 'a': must be a map",
                           "p.yaml:5: step 'b': has 'form' besides 'contour'",
                           "did you mean 'from'?",
                           "p.yaml:6: step 'c': has no operation",
                           "p.yaml:7: contour: must be a map of parameters",
                           "p.yaml:8: contour values: must be a value or a list, not a map",
                           "p.yaml:9: contour values: the items of a list must be values",
                           "p.yaml:10: contour words: 'a,b': a list item must not contain a comma",
                           "p.yaml:11: step 'h': from: must be the name",
                           "p.yaml:12: read path: the items of a list must be values",
                           "p.yaml:13: steps: the key 'i' appears twice",
                           "p.yaml:14: contour: the key 'a' appears twice",
                           "p.yaml:15: contour: 'a=b' is not a valid name",
                           "p.yaml:17: show: unknown way to show 'surfcae'; did you mean 'surface'?",
                           "p.yaml:18: show: has no kind",
                           "p.yaml:19: show: of: must be the name of a step",
                           "p.yaml:20: show: each item must be a way to show",
                           "p.yaml:21: picture: unknown key 'sise'; did you mean 'size'?",
                           "p.yaml:21: picture camera.a: must be a value or a list"})
    CHECK_MESSAGE(text.find(part) != std::string::npos, part << " in " << text);
}

TEST_CASE("pipeline file: a file that is none says what one is") {
  CHECK(has(error_of(""), "a pipeline file must be a map"));
  CHECK(has(error_of("hello"), "p.yaml:1: a pipeline file must be a map"));
  CHECK(has(error_of("steps: {a: {read: x}}"), "the key 'sightglass' is missing; begin the file with sightglass: 1"));
  CHECK(has(error_of("sightglass: 1"), "there are no steps"));
  CHECK(has(error_of("sightglass: 1\nsteps: [a]\nshow: {}\npicture: 7"), "p.yaml:2: steps: must be a map of names"));
  CHECK(has(error_of("sightglass: 1\nsteps: [a]\nshow: {}\npicture: 7"), "p.yaml:3: show: must be a list"));
  CHECK(has(error_of("sightglass: 1\nsteps: [a]\nshow: {}\npicture: 7"), "p.yaml:4: picture: must be a map"));
}

TEST_CASE("pipeline file: bad syntax is told with its line") {
  CHECK(has(error_of("sightglass: 1\nsteps: {a: [\n"), "p.yaml:3:"));
  CHECK(has(error_of("sightglass: 1\nsteps:\n\ta: b\n"), "p.yaml:"));
  CHECK(has(error_of("a: 1\n---\nb: 2\n"), "more than one document"));
  CHECK(has(error_of("? [a]\n: b\n"), "p.yaml:1: a key must be a plain word"));
  CHECK(has(error_of(std::string(300, 'k') + ": 1\n"), "more than 256 characters"));
}

TEST_CASE("pipeline file: anchors, aliases, tags, depth and size are bounded") {
  CHECK(has(error_of("a: &x [1]\nb: *x\n"), "p.yaml:1: anchors (&name) are not allowed"));
  CHECK(has(error_of("b: *x\n"), "p.yaml:1:"));
  CHECK(has(error_of("a: !!binary x\n"), "tags"));
  std::string bomb = "a: &a [l, l, l]\n";
  for (char c = 'b'; c <= 'z'; ++c) bomb += std::string(1, c) + ": &" + c + " [*" + char(c - 1) + ", *" + char(c - 1) + "]\n";
  CHECK(has(error_of(bomb), "anchors"));
  CHECK(has(error_of(std::string(33, '[') + std::string(33, ']')), "more than 32 levels"));
  CHECK(has(error_of(std::string(100000, '[')), "p.yaml:1:"));
  CHECK(has(error_of(std::string(100000, '{')), "p.yaml:1:"));
  CHECK(has(error_of(std::string((1 << 20) + 1, ' ')), "at most 1.0 MiB"));
  std::string many = "[";
  for (int i = 0; i < 100001; ++i) many += "1,";
  CHECK(has(error_of(many + "1]"), "more than 100000 values"));
}

TEST_CASE("pipeline file: damaged text gives an error or a file, never anything else") {
  const std::string text = example;
  int parsed = 0, refused = 0;
  for (uint64_t i = 0; i < 3000; ++i) {
    std::string t = text;
    for (uint64_t k = 0; k <= random_bits(1, i) % 3; ++k) {
      const uint64_t r = random_bits(i + 2, k);
      const size_t at = size_t(r % t.size());
      if (r >> 62 == 0) t.erase(at, size_t(r >> 20) % 9);
      else if (r >> 62 == 1) t.insert(at, 1, "{}[]:,&*\"'\n -#?|>!"[(r >> 30) % 18]);
      else t[at] = char((r >> 40) & (r >> 61 & 1 ? 0x7f : 0xff));
    }
    try {
      const PipelineFile f = parse_pipeline(t);
      ++parsed;
      CHECK(parse_pipeline(emit_pipeline(f), "", {{}, {}}) == f);
    } catch (const Error& e) {
      ++refused;
      CHECK(e.kind() == ErrorKind::usage);
    }
  }
  CHECK(parsed > 100);
  CHECK(refused > 100);
}

TEST_CASE("pipeline file: becomes a graph, paths beside the file") {
  write_file(test::temp_folder() + "in.raw", "1234");
  const std::string path = test::temp_folder() + "p.yaml";
  write_file(path,
             "sightglass: 1\n"
             "steps:\n"
             "  in: {read: {path: in.raw, dims: [4, 1, 1], type: u8}}\n"
             "  twice: {scale: {by: 2}}\n"
             "  line: {ramp: {n: 4, start: 1}}\n"
             "  more: {scale: {by: 10}}\n"
             "  sum: {add: , from: [twice, more]}\n"
             "show:\n"
             "  - {surface: , of: twice}\n"
             "  - outline\n");
  PipelineGraph p = build_graph(read_pipeline(path), test_options());
  Context context;
  CHECK(test::value_at(p.graph.evaluate(p.last, {}, context), 3) == 6 + 40);
  CHECK(p.nodes.size() == 5);
  CHECK(p.nodes[1].first == "twice");
  REQUIRE(p.show.size() == 2);
  CHECK(p.show[0] == p.nodes[1].second);
  CHECK(p.show[1] == p.last);
  CHECK(p.graph.explain(p.last).find("sum ") != std::string::npos);
}

TEST_CASE("pipeline file: mistakes in operations and names are told with their lines, all at once") {
  const std::string yaml =
      "sightglass: 1\n"
      "steps:\n"
      "  a: {scale: {by: 1}}\n"
      "  b: {ramp: {n: 0}}\n"
      "  c: {scael: {by: 1}}\n"
      "  d: {scale: {bye: 1, mode: fnacy}, from: bb}\n"
      "  e: {add: , from: [b, f]}\n"
      "  f: {scale: , from: f}\n"
      "  g: {read: absent.vti, from: a}\n"
      "  h: {read: {path: x.raw, dims: [1, 2], type: u8}}\n"
      "  i: {read: {path: x.raw, dims: [1, 2, 3], type: u7}}\n"
      "  j: {read: {fields: [T]}}\n"
      "  k: {read: {path: x.raw, dims: [1, 2, 3]}}\n"
      "  l: {ramp: , from: b}\n"
      "show:\n"
      "  - {surface: , of: z}\n";
  const std::string text = test::error_of([&] { build_graph(parse_pipeline(yaml, "/p.yaml"), test_options()); });
  for (const char* part :
       {"15 errors:", "/p.yaml:3: step 'a': scale: takes 1 input, not 0", "/p.yaml:4: step 'b': ramp n: '0' is not in range",
        "/p.yaml:5: step 'c': unknown operation 'scael'; did you mean 'scale'?",
        "/p.yaml:6: step 'd': there is no step 'bb'; did you mean 'b'?",
        "/p.yaml:6: step 'd': scale: unknown parameter 'bye'; did you mean 'by'?", "did you mean 'fancy'?",
        "/p.yaml:7: step 'e': its input 'f' comes later; move that step up", "/p.yaml:8: step 'f': its input 'f' comes from itself",
        "/p.yaml:9: step 'g': /absent.vti: no such file", "/p.yaml:9: step 'g': read takes no input",
        "/p.yaml:10: step 'h': read dims: '1,2' is not a list of 3", "/p.yaml:11: step 'i': read type: 'u7' is not a number type",
        "/p.yaml:12: step 'j': read path: no file is given", "/p.yaml:13: step 'k': read type: a raw brick needs a number type",
        "/p.yaml:14: step 'l': ramp: is a source and takes no input", "/p.yaml:16: show surface: there is no step 'z'"})
    CHECK_MESSAGE(text.find(part) != std::string::npos, part << " in " << text);
  CHECK(test::all_runs() == 0);
}

TEST_CASE("pipeline file: names that are used twice are refused when built from words") {
  PipelineFile f;
  f.steps = {{"a", "ramp", {}, {}, 3}, {"a", "ramp", {}, {}, 4}};
  CHECK(has(test::error_of([&] { build_graph(f, test_options()); }), "pipeline:4: there are two steps 'a'"));
  CHECK(has(test::error_of([&] { build_graph({}, test_options()); }), "there are no steps"));
}

TEST_CASE("pipeline file: of very many mistakes the first are told") {
  PipelineFile f;
  for (int i = 0; i < 3000; ++i) f.steps.push_back({"s" + std::to_string(i), i ? "scael" : "ramp", {}, {}, i + 1});
  const std::string text = test::error_of([&] { build_graph(f, test_options()); });
  CHECK(has(text, "2999 errors:"));
  CHECK(text.ends_with("... and 2949 more"));
}

TEST_CASE("pipeline file: a missing file is an error of data") {
  CHECK(has(test::error_of([] { read_pipeline("/nowhere/p.yaml"); }), "no such file"));
}
