#include "castray/image_bands.h"

#include <algorithm>

#include "core/files.h"
#include "image/row_writer.h"

namespace castray {

namespace {

/// The files are open one within the other, so that all are kept or none.
class BandedFiles {
 public:
  BandedFiles(const std::vector<std::filesystem::path>& files, const WrittenImage& image, int band,
              const ImageRows& rows, Image first)
      : files_(files), image_(image), band_(band), rows_(rows), first_(std::move(first)) {}

  void write(std::size_t file = 0) {
    if (file == files_.size()) return write_rows();
    write_file(files_[file], [&](std::ostream& out) {
      writers_.push_back(row_writer(files_[file], out, image_));
      write(file + 1);
      writers_[file]->finish();
      writers_[file].reset();  // some formats end when their writer does
    });
  }

 private:
  void write_rows() {
    add(first_);
    for (int y = first_.height; y < image_.height; y += band_)
      add(rows_(y, std::min(y + band_, image_.height)));
  }
  void add(const Image& rows) {
    for (const auto& writer : writers_) writer->add(rows);
  }

  const std::vector<std::filesystem::path>& files_;
  const WrittenImage& image_;
  int band_;
  const ImageRows& rows_;
  Image first_;
  std::vector<std::unique_ptr<RowWriter>> writers_;
};

}  // namespace

void write_image_in_bands(const std::vector<std::filesystem::path>& files, int width, int height, int band,
                          const ImageRows& rows, const Display& display,
                          const std::function<Metadata()>& metadata) {
  Image first = rows(0, std::min(band, height));
  const Metadata told = metadata();
  const std::optional<Noise> none;
  const Passes no_passes;
  BandedFiles(files, {width, height, display, told, none, no_passes}, band, rows, std::move(first)).write();
}

}  // namespace castray
