// SPDX-License-Identifier: Apache-2.0
// Everything that can be requested, in one table: what help, completions, other languages and the browser are made of.
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/schema/schema.h"
#include "io/io.h"
#include "pipeline/operation/operation.h"

namespace sg {

enum class EntryKind {
  source,     ///< computes data from nothing
  operation,  ///< data to data
  show,       ///< a way to show data
  reader,     ///< a format that is read
  writer,     ///< a format that is written
  read,       ///< a step that reads a file of whatever format
  camera,
  picture,
  film,
  page,
  light,        ///< a kind of light of a picture
  environment,  ///< a kind of what is around it
  node,         ///< of a scene; its instances; its keys
};
constexpr auto enum_words(EntryKind) {
  using enum EntryKind;
  return std::array{Word{"source", source}, Word{"operation", operation}, Word{"show", show},     Word{"reader", reader},
                    Word{"writer", writer}, Word{"read", read},           Word{"camera", camera}, Word{"picture", picture},
                    Word{"film", film},     Word{"page", page},           Word{"light", light},   Word{"environment", environment},
                    Word{"node", node}};
}

struct CatalogEntry {
  EntryKind kind;
  std::string name, sentence;
  std::shared_ptr<void> values;          ///< the parameter struct
  Schema schema;                         ///< refers into `values`, which hold the defaults
  const Operation* operation = nullptr;  ///< of sources and operations
  const Format* format = nullptr;        ///< of readers and writers
};

/// By kind, in the order of EntryKind.
std::vector<CatalogEntry> catalog();

/// {"name","kind","sentence","params":<JSON Schema, draft 2020-12>}; of operations and sources "family", "version", "inputs" ([least,
/// most], most -1: any number), "takes" (of the first input and of each further one a list of DataKind; a collection: its parts), "makes"
/// ({"same","else","parts"}: a first input of a kind in "same" gives the same kind, any other and none at all one in "else"; with "parts"
/// as a collection of several) and "words" ([{"group","form","sentence"}]) where they have a language; of readers and writers "extensions",
/// of readers "times" (its files may hold several).
std::string entry_json(const CatalogEntry& entry);
/// {"sightglass":VERSION,"sources":[...],"operations":[...],"show":[...],"readers":[...],"writers":[...],"read":{...},"camera":{...},
/// "picture":{...},"film":{...},"page":{...},"lights":[...],"environments":[...],"nodes":[...]}.
std::string catalog_json(const std::vector<CatalogEntry>& entries);

}  // namespace sg
