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
void write_metaimage(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

Data read_raw(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_ply(std::span<const std::byte> head);
Data read_ply(const std::string& path, const ReadOptions& options, Context& context);
void write_ply(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

Data read_stl(const std::string& path, const ReadOptions& options, Context& context);
void write_stl(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

Data read_obj(const std::string& path, const ReadOptions& options, Context& context);
void write_obj(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_nifti(std::span<const std::byte> head);
Data read_nifti(const std::string& path, const ReadOptions& options, Context& context);
std::vector<double> times_of_nifti(const std::string& path, const ReadOptions& options, Context& context);
void write_nifti(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_npy(std::span<const std::byte> head);
Data read_npy(const std::string& path, const ReadOptions& options, Context& context);
void write_npy(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

bool sniff_slc(std::span<const std::byte> head);
Data read_slc(const std::string& path, const ReadOptions& options, Context& context);

Data read_cube(const std::string& path, const ReadOptions& options, Context& context);

bool sniff_dicom(std::span<const std::byte> head);
bool sniff_dicom_folder(const std::string& path);

bool sniff_vdb(std::span<const std::byte> head);

bool sniff_png(std::span<const std::byte> head);
bool sniff_jpeg(std::span<const std::byte> head);
bool sniff_tiff(std::span<const std::byte> head);
bool sniff_picture_folder(const std::string& path);
Data read_png_grid(const std::string& path, const ReadOptions& options, Context& context);
Data read_jpeg_grid(const std::string& path, const ReadOptions& options, Context& context);
Data read_picture_stack(const std::string& path, const ReadOptions& options, Context& context);

}  // namespace sg
