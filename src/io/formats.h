// SPDX-License-Identifier: Apache-2.0
// The reading and writing functions of every format: one .cpp per format, bodies there.
#pragma once
#include "io/io.h"

namespace sg {

bool sniff_vtk_legacy(std::span<const std::byte> head);
Data read_vtk_legacy(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_vtk_xml(std::span<const std::byte> head);
Data read_vtk_xml(const std::string& path, const ReadOptions& options, Context& context);
void write_vtk_xml(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_nrrd(std::span<const std::byte> head);
Data read_nrrd(const std::string& path, const ReadOptions& options, Context& context);
void write_nrrd(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_metaimage(std::span<const std::byte> head);
Data read_metaimage(const std::string& path, const ReadOptions& options, Context& context);

Data read_raw(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_ply(std::span<const std::byte> head);
Data read_ply(const std::string& path, const ReadOptions& options, Context& context);
void write_ply(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

Data read_stl(const std::string& path, const ReadOptions& options, Context& context);
void write_stl(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

Data read_obj(const std::string& path, const ReadOptions& options, Context& context);
void write_obj(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_vtk_parallel(std::span<const std::byte> head);
Data read_vtk_parallel(const std::string& path, const ReadOptions& options, Context& context);
/// *.pvtu and *.pvtp: the datasets of a collection are the pieces of one mesh.
void write_vtk_parallel(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
bool sniff_vtk_multiblock(std::span<const std::byte> head);
Data read_vtk_multiblock(const std::string& path, const ReadOptions& options, Context& context);
/// Parts go into a folder of the file's name without its extension.
void write_vtk_multiblock(const std::string& path, const Data& data, const WriteOptions& options, Context& context);
bool sniff_pvd(std::span<const std::byte> head);
Data read_pvd(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_pvd(const std::string& path, const ReadOptions& options, Context& context);
bool sniff_vtk_amr(std::span<const std::byte> head);
Data read_vtk_amr(const std::string& path, const ReadOptions& options, Context& context);
/// Patches go into a folder of the file's name without its extension.
void write_vtk_amr(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

}  // namespace sg
