// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/vtk_parts_folder.h"

#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/file/file.h"
#include "base/file/partial_file.h"
#include "base/text/text.h"

namespace sg::vtk {

namespace {

// The folder holds files only; what is not a file stays, and the folder with it.
void remove_folder(const std::string& folder) {
  if (!is_folder(folder)) return;
  for (const std::string& name : folder_entries(folder)) ::unlink((folder + "/" + name).c_str());
  ::rmdir(folder.c_str());
}

}  // namespace

PartsFolder::PartsFolder(const std::string& path) {
  const std::string name = file_name_of(path);
  stem_ = name.substr(0, name.rfind('.'));
  folder_ = folder_of(path) + stem_;
  if (is_folder(folder_)) {
    for (const std::string& entry : folder_entries(folder_))
      if (!entry.starts_with(stem_ + "_") || !extension_of(entry).starts_with("vt"))
        fail_usage(fmt::format("the folder for the parts holds other files ('{}')", entry), folder_, "choose another name");
  } else if (file_exists(folder_)) {
    fail_usage("a file already has the name needed for the folder of parts", folder_, "choose another name");
  }
  header_.emplace(std::vector<std::string>{path});
  partial_ = make_partial_folder(folder_, false), old_ = partial_ + "-old";
}

PartsFolder::~PartsFolder() {
  const CleaningUp busy;
  if (!done_) remove_folder(partial_);
}

std::string PartsFolder::file(size_t i, std::string_view extension) const {
  return fmt::format("{}/{}_{}.{}", partial_, stem_, i, extension);
}
std::string PartsFolder::name(size_t i, std::string_view extension) const { return fmt::format("{}/{}_{}.{}", stem_, stem_, i, extension); }

void PartsFolder::commit(std::string_view text) {
  header_->write(0, text);
  header_->finish();
  const bool replaces = is_folder(folder_);
  if (replaces && ::rename(folder_.c_str(), old_.c_str()) != 0)
    fail_data(std::string("cannot be replaced: ") + std::strerror(errno), folder_);
  if (::rename(partial_.c_str(), folder_.c_str()) != 0) {
    const int error = errno;
    if (replaces) ::rename(old_.c_str(), folder_.c_str());
    fail_data(std::string("cannot be written: ") + std::strerror(error), folder_);
  }
  try {
    header_->commit();
  } catch (...) {
    if (::rename(folder_.c_str(), partial_.c_str()) == 0 && replaces) ::rename(old_.c_str(), folder_.c_str());
    throw;
  }
  done_ = true;
  remove_folder(old_);
}

}  // namespace sg::vtk
