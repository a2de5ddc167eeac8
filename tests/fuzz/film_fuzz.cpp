// The film reader, and the sum with itself, which must be refused.
#include "fuzz.h"
#include "image/formats.h"

FUZZ(bytes) {
  castray::Film film = castray::parse_film("fuzz", bytes);
  film.merge(film);
}
