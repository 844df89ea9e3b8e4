// SPDX-License-Identifier: Apache-2.0
// The options of readers and writers, declared like the parameters of an operation: flags, pipeline files, help and JSON schema are made
// of these declarations.
#pragma once
#include "base/schema/schema.h"
#include "io/io.h"

namespace sg {

/// A step that reads.
struct ReadParams {
  std::string path;
  ReadOptions options;  ///< header_only is not a parameter
};
void describe(Schema& s, ReadParams& p);
void describe(Schema& s, ReadOptions& p);
/// The same for one format: the path, the common options, and those of this format.
void describe(Schema& s, ReadParams& p, const Format& format);

/// Throws Error(usage) for options that do not go together: a size without a type, a region that ends before it begins, ...
void check(const ReadOptions& options);
/// The words that set_params() takes to come to the same ReadParams.
std::vector<std::string> read_words(const std::string& path, const ReadOptions& options);

/// The options of a format that is written, from "key=value" words. Throws Error(usage) for words that the format has not.
WriteOptions write_options(const Format& format, const std::vector<std::string>& words);

// Declarations for formats.def.
void describe_raw(Schema& s, ReadOptions& p);
void describe_csv(Schema& s, ReadOptions& p);
void describe_text_or_binary(Schema& s, WriteOptions& p);
void describe_nrrd(Schema& s, WriteOptions& p);
void describe_zlib(Schema& s, WriteOptions& p);
void describe_vtk_xml(Schema& s, WriteOptions& p);
void describe_vtk_pieces(Schema& s, WriteOptions& p);
void describe_zarr(Schema& s, WriteOptions& p);

}  // namespace sg
