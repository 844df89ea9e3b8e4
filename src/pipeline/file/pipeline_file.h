// SPDX-License-Identifier: Apache-2.0
// Pipeline files: steps, what to show, and the picture, as YAML. The same text is the recipe inside a picture.
//
//   sightglass: 1
//   steps:
//     head: {read: FullHead.mhd}
//     bone: {contour: {values: [1150]}, from: head}     # `from` is the step before unless stated; a list for several inputs
//   show:
//     - {surface: {color: "0.9,0.85,0.8"}, of: bone}    # `of` is the last step unless stated
//   scene:                                              # what is shown where: nodes with transforms (docs/scene.md)
//     - {node: lid, axis: [1, 0, 0], angle: 40, show: [{surface: {}, of: bone}]}
//   picture: {size: 1280x720, camera: {direction: [1, 0.5, 0.3]}, output: out.png}
// The picture of a series: output: out_{n}.png or film.webm, times: "0:10:101" (default: all of the file), fps: 25.
#pragma once
#include <concepts>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/graph/graph.h"

namespace sg {

/// What a step does, by the word in `operation`: an operation where it is none of these.
enum class StepKind { operation, read, memory };
constexpr auto enum_words(StepKind) { return std::array{Word{"read", StepKind::read}, Word{"memory", StepKind::memory}}; }
inline StepKind step_kind(std::string_view operation) { return value_of_word<StepKind>(operation).value_or(StepKind::operation); }
/// The operation of a step whose numbers came from the memory of a program that used the library: a recipe names it, and only with its
/// result at hand is it good for anything.
inline constexpr std::string_view memory_step = word_of(StepKind::memory);

/// The file as plain data. Words are "key=value" as on the command line; lists become "1,2,3", a key without a value the bare
/// word. Equality leaves out `origin`, `absolute` and the lines.
struct PipelineFile {
  struct Step {
    std::string name;
    std::string operation;           ///< "read" or the name of an operation
    std::vector<std::string> words;  ///< of read: those of ReadParams in io/options.h ("path=FullHead.mhd")
    std::vector<std::string> from;   ///< names of steps further up; empty = the step before (sources: none)
    int line = 0;
    bool reads() const { return step_kind(operation) == StepKind::read; }
    friend bool operator==(const Step& a, const Step& b) {
      return a.name == b.name && a.operation == b.operation && a.words == b.words && a.from == b.from;
    }
  };
  struct Show {
    std::string kind;  ///< "surface", "volume", ...
    std::vector<std::string> words;
    std::string of;  ///< "" = the last step
    int line = 0;
    int node = -1;  ///< of the scene, where it is shown; -1: where the data lie
    friend bool operator==(const Show& a, const Show& b) {
      return a.kind == b.kind && a.words == b.words && a.of == b.of && a.node == b.node;
    }
  };
  struct Node {
    std::string name;
    std::vector<std::string> words;                         ///< those of NodeParams
    int parent = -1;                                        ///< of the scene, further up
    std::vector<std::vector<std::string>> instances, keys;  ///< those of InstanceParams, KeyParams
    std::string at;                                         ///< step whose points are places of instances; "" = none
    std::vector<std::string> at_words;                      ///< those of PointInstancesParams
    int line = 0;
    friend bool operator==(const Node& a, const Node& b) {
      return a.name == b.name && a.words == b.words && a.parent == b.parent && a.instances == b.instances && a.keys == b.keys &&
             a.at == b.at && a.at_words == b.at_words;
    }
  };
  std::vector<Step> steps;
  std::vector<Show> show;
  std::vector<Node> scene;           ///< each after its parent
  std::vector<std::string> picture;  ///< words; those of a map inside have its name in front: "camera.direction=1,0.5,0.3"
  int picture_line = 0;
  std::string origin;     ///< file name, for messages and relative paths; "" = none
  bool absolute = false;  ///< a recipe of it names files absolutely: made where nobody knew where its picture would lie

  friend bool operator==(const PipelineFile& a, const PipelineFile& b) {
    return a.steps == b.steps && a.show == b.show && a.scene == b.scene && a.picture == b.picture;
  }
};

/// Words allowed in a file, for "did you mean". An empty list lets everything pass.
struct PipelineVocabulary {
  std::vector<std::string> show{"auto", "surface", "volume", "lines", "points", "labels", "glyphs", "outline"};
  std::vector<std::string> picture{"size", "camera", "output", "background", "background_top", "transparent", "title", "legend", "axes"};
};

/// Throws one Error(usage) with all mistakes, each with "origin:line". Anchors and aliases are refused, as are more than 32
/// levels and more than 1 MiB.
PipelineFile parse_pipeline(std::string_view text, const std::string& origin = {}, const PipelineVocabulary& vocabulary = {});
/// From a file; its folder is where relative paths begin.
PipelineFile read_pipeline(const std::string& path, const PipelineVocabulary& vocabulary = {});

/// Text that parse_pipeline reads back to an equal PipelineFile; the same bytes for equal files. Of several words with one key
/// only the last, which is the one that counts, is written. Throws Error(usage) for text that is not UTF-8.
std::string emit_pipeline(const PipelineFile& file);

/// The words below a map of the picture, without its name: ("camera") -> "direction=1,0.5,0.3".
std::vector<std::string> words_under(const std::vector<std::string>& words, std::string_view map);
/// The value of "key=value"; nothing when there is no such word.
std::optional<std::string> word_value(const std::vector<std::string>& words, std::string_view key);

struct PipelineGraph {
  Graph graph;
  std::vector<std::pair<std::string, NodeId>> nodes;  ///< of each step, in file order
  std::vector<NodeId> show;                           ///< of each show, in file order
  NodeId last = -1;                                   ///< of the last step
  std::vector<NodeId> places = {};                    ///< of each node of the scene the points of its instances; -1: none
};
/// Data at hand. Equal words in `content` vouch for equal data, as those of Graph::add_data().
struct StepResult {
  Data data;
  std::string content;
  StepResult() = default;
  template <class D>
  requires std::convertible_to<D, Data> StepResult(D d, std::string c = {}) : data(std::move(d)), content(std::move(c)) {}
};
/// Results at hand by the names of their steps, which then do not run; a null dataset: it is above others at hand and not requested.
using StepResults = std::map<std::string, StepResult>;
/// Throws one Error with all mistakes of the file and its operations, each with "origin:line".
PipelineGraph build_graph(const PipelineFile& file, GraphOptions options = {}, const StepResults& results = {});

}  // namespace sg
