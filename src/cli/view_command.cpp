// SPDX-License-Identifier: Apache-2.0
// view and serve: windows in the browser.
#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "cli/chain.h"
#include "cli/cli.h"
#include "cli/say.h"
#include "pipeline/picture/picture.h"
#include "serve/guard/token.h"
#include "serve/guard/users.h"
#include "serve/serve.h"

namespace sg {

namespace {

serve::ServeParams serve_params(const Options& o) {
  serve::ServeParams p;
  Schema schema = schema_of(p);
  set_params(schema, o.serve, "serve");
  p.browser = !o.no_browser;
  return p;
}

bool is_pipeline_file(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == "yaml" || extension == "yml";
}

}  // namespace

int run_view(const Options& o, Context& context) {
  const bool pipeline = o.inputs.size() == 1 && is_pipeline_file(o.inputs[0]);
  PipelineFile file = pipeline ? read_pipeline(o.inputs[0], picture_vocabulary()) : pipeline_of(o);
  if (file.show.empty()) file.show.push_back({std::string(auto_show), {}, file.steps.empty() ? "" : file.steps.back().name, 0});
  const std::string title = o.inputs.empty() ? file.steps.at(0).operation : file_name_of(o.inputs[0]);
  serve::view(std::move(file), coloring_words(o), title, serve_params(o), context);
  return 0;
}

int run_serve(const Options& o, Context& context) {
  if (!o.add_user.empty()) {
    const std::vector<std::string> words = quoted_words(o.add_user);
    const auto rights = words.size() == 2 ? value_of_word<serve::Rights>(words[1]) : std::nullopt;
    if (!rights)
      fail_usage(fmt::format("'{}' is no user with rights", o.add_user), "--add-user", "write e.g. --add-user 'anna edit', or view");
    const std::string token = serve::new_token();
    say(fmt::format("token for {} (it is not stored anywhere): {}\nline for the file of users: {}", words[0], token,
                    serve::user_line(words[0], *rights, token)));
    return 0;
  }
  serve::serve(o.inputs.at(0), serve_params(o), context);
  return 0;
}

}  // namespace sg
