#pragma once

#include <string>

#include "castray/image.h"

namespace castray::cli {

// Packets of the protocol by which the viewer tev (github.com/Tom94/tev) takes images from a network: 32 bits
// of length, itself included, a byte that tells the operation, then its fields; all little-endian.

/// Makes a black image.
std::string tev_create_packet(const std::string& name, int width, int height);
/// Rows y0 <= y < y1 of the image.
std::string tev_update_packet(const std::string& name, const Image& image, int y0, int y1);

/// Shows an image in a running tev.
class TevViewer {
 public:
  /// Connects. `address`: "HOST:PORT", or a port of this machine. Throws InputError where no tev answers.
  TevViewer(const std::string& address, const std::string& name, int width, int height);
  ~TevViewer();
  TevViewer(const TevViewer&) = delete;
  TevViewer& operator=(const TevViewer&) = delete;

  /// Shows the whole image anew. If tev is gone, says so on stderr, once.
  void show(const Image& image);

 private:
  void send(const std::string& packet);

  std::string address_, name_;
  int socket_ = -1;
};

}  // namespace castray::cli
