// Compiled to see whether the archives link: what we use of each.
#include <cstdio>  // before jpeglib.h, which needs it

#include <jpeglib.h>
#include <png.h>
#include <sqlite3.h>
#include <tiffio.h>

int main() {
  TIFF* const tiff = TIFFOpen("", "r");
  if (tiff != nullptr) TIFFClose(tiff);
  png_structp png =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_destroy_read_struct(&png, nullptr, nullptr);
  jpeg_decompress_struct jpeg;
  jpeg_create_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  sqlite3* store = nullptr;
  sqlite3_open(":memory:", &store);
  sqlite3_close(store);
}
