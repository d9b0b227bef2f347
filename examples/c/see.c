/* Shows an image to a trained model and prints what it sees:
 *
 *     see MODEL IMAGE.ppm
 *
 * MODEL is a checkpoint or the folder of a run, the image a binary PPM (convert photo.jpg photo.ppm). Prints a line
 * of the nearest and farthest depth, and a line an object: slot, share, location, then yaw with its probability, or
 * the nine numbers of its rotation from a model that tells rotations. */
#include <stdio.h>
#include <stdlib.h>
#include <vkopple.h>

typedef struct picture {
  int height, width;
  unsigned char* pixels;
} picture;

static int fail(const char* what, const char* why) {
  fprintf(stderr, "see: %s: %s\n", what, why);
  return 1;
}

/* "P6 WIDTH HEIGHT 255", one white space, pixels. Comments are not understood. Null pixels on failure. */
static picture read_ppm(const char* path) {
  picture image = {0, 0, NULL};
  int most = 0;
  FILE* file = fopen(path, "rb");
  if (file == NULL) return image;
  if (fscanf(file, "P6 %d %d %d", &image.width, &image.height, &most) == 3 && most == 255 && fgetc(file) != EOF &&
      image.width > 0 && image.height > 0 && image.width <= 16384 && image.height <= 16384) {
    const size_t bytes = (size_t)3 * (size_t)image.width * (size_t)image.height;
    image.pixels = malloc(bytes);
    if (image.pixels != NULL && fread(image.pixels, 1, bytes, file) != bytes) {
      free(image.pixels);
      image.pixels = NULL;
    }
  }
  fclose(file);
  return image;
}

static void print_object(const vkopple_seen* seen, size_t i, const vkopple_object* o) {
  const double* rotation = vkopple_seen_rotation(seen, i);
  printf("object %zu %.17g %.17g %.17g %.17g", i, o->share, o->location[0], o->location[1], o->location[2]);
  if (rotation == NULL) printf(" %.17g %.17g", o->yaw, o->yaw_probability);
  for (int k = 0; rotation != NULL && k < 9; ++k) printf(" %.17g", rotation[k]);
  printf("\n");
}

static void print_seen(const vkopple_seen* seen) {
  int32_t height = 0, width = 0;
  size_t count = 0;
  const float* depth = vkopple_seen_depth(seen);
  const vkopple_object* objects = vkopple_seen_objects(seen, &count);
  float nearest = depth[0], farthest = depth[0];
  vkopple_seen_size(seen, &height, &width);
  for (size_t i = 0; i < (size_t)height * (size_t)width; ++i) {
    if (depth[i] < nearest) nearest = depth[i];
    if (depth[i] > farthest) farthest = depth[i];
  }
  printf("depth %.9g %.9g\n", (double)nearest, (double)farthest);
  for (size_t i = 0; i < count; ++i) print_object(seen, i, &objects[i]);
}

int main(int argc, char** argv) {
  vkopple_model* model = NULL;
  vkopple_seen* seen = NULL;
  vkopple_image image = {NULL, 0, 0, 0, VKOPPLE_RGB8};
  picture read;
  int code = 0;
  if (argc != 3) {
    fprintf(stderr, "usage: see MODEL IMAGE.ppm\n");
    return 2;
  }
  read = read_ppm(argv[2]);
  if (read.pixels == NULL) return fail(argv[2], "is no binary PPM of 8 bits that can be read");
  image.pixels = read.pixels;
  image.height = read.height;
  image.width = read.width;
  if (vkopple_load(argv[1], NULL, &model) != VKOPPLE_OK)
    code = fail("model", vkopple_last_error());
  else if (vkopple_see(model, &image, &seen) != VKOPPLE_OK)
    code = fail(argv[2], vkopple_last_error());
  else
    print_seen(seen);
  vkopple_seen_free(seen);
  vkopple_free(model);
  free(read.pixels);
  return code;
}
