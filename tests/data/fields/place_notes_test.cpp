// SPDX-License-Identifier: Apache-2.0
#include "data/fields/place_notes.h"

#include "support/test.h"

using namespace sg;

TEST_CASE("place notes: what is made of a scan lies where the scan lies, unless it says where it is") {
  using Notes = std::vector<std::pair<std::string, std::string>>;
  DatasetParts parts;
  parts.mesh = UniformGrid();
  parts.notes = {{"space", "left-posterior-superior"}, {"length unit", "mm"}, {"Modality", "MR"}};
  const DatasetPtr scan = make_dataset(parts);
  parts.notes = {{"labels of kind", "0=a"}};
  const DatasetPtr made = make_dataset(parts);
  parts.notes = {{"length unit", "m"}};
  const DatasetPtr own = make_dataset(parts);
  auto both = std::make_shared<Collection>();
  both->parts = {{"made", made}, {"own", own}, {"table", TablePtr(std::make_shared<Table>())}, {"none", DatasetPtr()}};

  const Data placed = with_place_of(*scan, CollectionPtr(both));
  const auto& out = std::get<CollectionPtr>(placed)->parts;
  CHECK(std::get<DatasetPtr>(out[0].data)->notes() ==
        Notes{{"labels of kind", "0=a"}, {"space", "left-posterior-superior"}, {"length unit", "mm"}});
  CHECK(std::get<DatasetPtr>(out[1].data)->notes() == own->notes());
  CHECK(std::get<DatasetPtr>(with_place_of(Data(scan), made))->notes().size() == 3);
  CHECK(std::get<DatasetPtr>(with_place_of(*made, made)) == made);  // nothing to say: the same dataset
}
