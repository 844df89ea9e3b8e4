// SPDX-License-Identifier: Apache-2.0
// Private to the library: what the values of sightglass.h hold, and how errors and parameters cross over.
#pragma once
#include <exception>
#include <new>
#include <optional>

#include "api/sightglass.h"
#include "base/context.h"
#include "base/error.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "image/image.h"
#include "io/lent_series.h"
#include "pipeline/file/pipeline_file.h"
#include "pipeline/film/film_params.h"
#include "pipeline/offline/page_params.h"
#include "pipeline/picture/picture.h"

namespace sightglass {

/// How data came to be: a step of a pipeline and those above it.
struct Made {
  std::string operation;           ///< "read", a source, an operation; memory_step: numbers of the caller's
  std::vector<std::string> words;  ///< what was stated
  std::vector<std::shared_ptr<const Made>> inputs;
  std::weak_ptr<const Data::Held> memory;      ///< of memory_step, as long as somebody holds them
  std::shared_ptr<const sg::LentSeries> lent;  ///< of "read", where it reads steps that the program makes
};

struct Data::Held {
  sg::Data data;
  std::shared_ptr<const Made> made;
  std::vector<std::string> notes = {};  ///< what was said while it was made
};

/// What a function of the program threw while the library worked.
struct Foreign : sg::Error {
  Foreign(std::string text, std::exception_ptr e) : sg::Error(sg::ErrorKind::data, std::move(text)), thrown(std::move(e)) {}
  std::exception_ptr thrown;
};
struct Array::Held {
  sg::Array array;
};
struct Context::State {
  sg::Context core;
  std::function<void(const Image&)> picture;
};

/// A context for work on data that keeps what is said, and passes it on.
class Noting {
 public:
  explicit Noting(const Context& context) : core(context.state().core, 0, 1) {
    core.on_log = [this, &outer = context.state().core](sg::LogLevel level, std::string_view text) {
      if (level != sg::LogLevel::debug) notes.emplace_back(text);
      outer.log(level, text);
    };
  }
  Noting(const Noting&) = delete;
  Noting& operator=(const Noting&) = delete;
  sg::Context core;
  std::vector<std::string> notes;
};
struct Image::Held {
  sg::Image image;
  sg::PipelineFile file;  ///< completed with what was chosen
  std::vector<std::string> notes;
  sg::Seen seen = {};
  std::vector<Legend> legends = {};
};

/// Has pictures on the way told to the context, if that wants any; `file` and `context` must outlive the work.
void watch(sg::PictureOptions& options, const sg::PipelineFile& file, const Context& context);
/// What is stated of a page. Throws Error(usage) for unknown words.
struct PageWords {
  sg::PageParams page;
  sg::FilmParams film;  ///< times
};
PageWords page_words(const Params& params);
/// Of those of a picture, what the library tells.
std::vector<Legend> told_legends(const std::vector<sg::Legend>& legends);

/// What leaves the library is sightglass::Error, or what the program itself has thrown.
template <class F>
decltype(auto) guarded(F&& f) {
  try {
    return f();
  } catch (const Foreign& e) {
    std::rethrow_exception(e.thrown);
  } catch (const sg::Error& e) {
    throw Error(Error::Kind(int(e.kind())), e.what(), e.problem(), e.where(), e.hint());
  } catch (const std::bad_alloc&) {
    const char* const problem = "not enough memory";
    throw Error(Error::Kind::data, std::string(problem) + "; use a smaller region or fewer fields", problem, "",
                "use a smaller region or fewer fields");
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(Error::Kind::internal, std::string("internal error: ") + e.what(), e.what(), "", "");
  }
}

/// Sets each; all mistakes in one Error(usage).
void set_values(sg::Schema& schema, const Params& params, std::string_view owner);
/// "name=value" of those that were stated.
std::vector<std::string> stated_words(const sg::Schema& schema);

/// Throws Error(usage) for empty Data.
const Data::Held& held_by(const Data& data);
/// From what an operation of `made` gave.
Data make_data(sg::Data data, std::shared_ptr<const Made> made, std::vector<std::string> notes = {});
/// From the caller's numbers; `about`: what a recipe says of them.
Data data_from_memory(sg::Data data, std::string about);
Data data_from_memory(sg::DatasetPtr data);

/// Numbers of the caller's above data, by the names of their steps. Throws Error(usage) naming `where` when they are gone.
class StepsOf;
void add_memory(const std::shared_ptr<const Made>& made, StepsOf& steps, sg::StepResults& results, std::string_view where);

/// Data as steps of a pipeline file: those above come first, each once.
class StepsOf {
 public:
  /// The name of the step that makes it.
  std::string add(const std::shared_ptr<const Made>& made);
  sg::PipelineFile file;

 private:
  std::vector<std::pair<const Made*, std::string>> names_;
};

/// The result of the last of these steps, all of which run, from numbers of the caller's on. Throws as add_memory().
sg::Data run_steps(const std::shared_ptr<const Made>& made, std::string_view where, sg::Context& context);
/// The times of what a "read" step reads, where it states none itself; else none.
std::vector<double> open_times(const Made& read, sg::Context& context);

struct Scene::State {
  struct Shown {
    Data data;
    std::string way;
    std::vector<std::string> words;
  };
  std::vector<Shown> shown;
  std::vector<std::string> camera, picture;  ///< words

  /// Steps, what is shown, and the picture. Gives each data shown, with the name of its step. Throws Error(usage) when nothing is shown.
  sg::PipelineFile pipeline(int width, int height,
                            const std::function<void(const std::string& step, const Data::Held& held, StepsOf& steps)>& each) const;
};

}  // namespace sightglass
