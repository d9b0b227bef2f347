/* vkopple's C interface: a trained model looks at images and tells masks, depth and objects.
 *
 *     vkopple_model* model = NULL;
 *     vkopple_seen* seen = NULL;
 *     vkopple_image image = {pixels, height, width, 0, VKOPPLE_RGB8};
 *     if (vkopple_load("run", NULL, &model) == VKOPPLE_OK && vkopple_see(model, &image, &seen) == VKOPPLE_OK)
 *       ... vkopple_seen_depth(seen) ...
 *     else
 *       puts(vkopple_last_error());
 *     vkopple_seen_free(seen);
 *     vkopple_free(model);
 *
 * Lengths are in scene units, angles in radians; the camera's frame has x right, y forward, z up; depth is the
 * Euclidean distance from the camera.
 *
 * Threads: a model may be used by one thread at a time. Different models, and what they saw, know nothing of
 * each other. What was seen may be read by any number of threads at once, and outlives its model.
 *
 * Stability: within one soversion functions, constants and structures stay as they are; structures that begin
 * with struct_size may grow at their end, and callers that were built before go on as they did. */
#ifndef VKOPPLE_H
#define VKOPPLE_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define VKOPPLE_API __attribute__((visibility("default")))
#else
#define VKOPPLE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum vkopple_status {
  VKOPPLE_OK = 0,
  VKOPPLE_FAILED = 1,       /* the work failed: a file, the device, the model's numbers */
  VKOPPLE_WRONG_USE = 2,    /* the caller asked for what can't be: a null pointer, a size, an unknown device */
  VKOPPLE_OUT_OF_MEMORY = 3 /* of the host */
} vkopple_status;

typedef enum vkopple_precision {
  VKOPPLE_FLOAT32 = 0,
  VKOPPLE_MIXED = 1 /* what lies between the networks' layers is kept in float16: half the memory */
} vkopple_precision;

typedef enum vkopple_pixel_format {
  VKOPPLE_RGB8 = 0,      /* three bytes a pixel: red, green, blue */
  VKOPPLE_RGB_FLOAT32 = 1 /* three floats a pixel, from 0 to 1; what is beyond is taken for the nearest */
} vkopple_pixel_format;

/* The library's version, "0.1.0". */
VKOPPLE_API const char* vkopple_version(void);

/* One line that says what was wrong in this thread's last call that returned a status, and what to do about it;
 * empty where it succeeded. Valid until the thread's next such call. */
VKOPPLE_API const char* vkopple_last_error(void);

/* ---- Models ---- */

typedef struct vkopple_model vkopple_model;

typedef struct vkopple_options {
  size_t struct_size; /* sizeof(vkopple_options) */
  const char* device; /* as --device of the program takes it; NULL: $VKOPPLE_DEVICE, else "auto" */
  int32_t precision;  /* a vkopple_precision, whatever the model was trained in */
} vkopple_options;

typedef struct vkopple_model_info {
  size_t struct_size; /* sizeof(vkopple_model_info), set by the caller */
  int32_t height;     /* pixels that the model works on; images of other sizes are resized to it */
  int32_t width;
  int32_t slots;        /* objects it can tell apart, beside the background */
  int32_t bins;         /* of an object's yaw; 0: the model tells rotations in space instead */
  int32_t sees_objects; /* 0: its object network has not learned yet, and only depth is told */
  double fov;           /* vertical angle of view for which locations hold */
  double max_depth;
  uint64_t step; /* steps of training done */
} vkopple_model_info;

/* Loads a model from a checkpoint or from the folder of a run (whose latest checkpoint is taken), onto a device of
 * its own. `options` may be NULL. On failure *model is NULL. */
VKOPPLE_API vkopple_status vkopple_load(const char* path, const vkopple_options* options,
                                        vkopple_model** model);
/* NULL is allowed. */
VKOPPLE_API void vkopple_free(vkopple_model* model);

VKOPPLE_API vkopple_status vkopple_get_model_info(const vkopple_model* model, vkopple_model_info* info);

/* ---- Seeing ---- */

typedef struct vkopple_image {
  const void* pixels; /* rows from the top, pixels from the left; of any alignment; only read during the call */
  int32_t height;     /* from 1 to 16384, as width; 2^26 pixels in all */
  int32_t width;
  size_t stride; /* bytes from a row to the next; 0: rows follow each other without a gap */
  int32_t format; /* a vkopple_pixel_format */
} vkopple_image;

/* What a slot of the model says of an object. */
typedef struct vkopple_object {
  double location[3];     /* in the camera's frame */
  double angle;           /* atan2(x, y): to the right of straight ahead */
  double distance;        /* sqrt(x^2 + y^2) */
  double yaw;             /* middle of the most likely bin, from 0 to 2 pi; 0 from a model that tells rotations */
  double yaw_probability; /* of that bin; 0 likewise */
  double share;           /* of the mask's pixels, from 0 to 1; 0: the slot is empty */
} vkopple_object;

/* What a model saw in an image. */
typedef struct vkopple_seen vkopple_seen;

/* Shows an image to the model. On failure *seen is NULL. */
VKOPPLE_API vkopple_status vkopple_see(vkopple_model* model, const vkopple_image* image, vkopple_seen** seen);
/* NULL is allowed. */
VKOPPLE_API void vkopple_seen_free(vkopple_seen* seen);

/* The functions below return pointers into what was seen, valid until vkopple_seen_free. `seen` must not be NULL;
 * the other pointers are written to and may be NULL. None can fail. */

/* The image's size, which mask and depth have. */
VKOPPLE_API void vkopple_seen_size(const vkopple_seen* seen, int32_t* height, int32_t* width);
/* (height, width): the index of each pixel's slot; the background's index is the model's number of slots. */
VKOPPLE_API const uint32_t* vkopple_seen_mask(const vkopple_seen* seen);
/* (height, width). */
VKOPPLE_API const float* vkopple_seen_depth(const vkopple_seen* seen);
/* The background's index in the mask, and its share of the pixels. */
VKOPPLE_API uint32_t vkopple_seen_background(const vkopple_seen* seen, double* share);
/* `count` objects, one a slot; none from a model that does not see objects. */
VKOPPLE_API const vkopple_object* vkopple_seen_objects(const vkopple_seen* seen, size_t* count);
/* Probabilities of `bins` bins of an object's yaw, bin i about 2 pi i / bins; NULL where there is no such
 * object, and from a model that tells rotations. */
VKOPPLE_API const double* vkopple_seen_pose(const vkopple_seen* seen, size_t object, size_t* bins);
/* The matrix of 3 x 3 numbers, row by row, that turns directions from an object's frame to the camera's; NULL where
 * there is no such object, and from a model that tells yaws. */
VKOPPLE_API const double* vkopple_seen_rotation(const vkopple_seen* seen, size_t object);
/* (planes, height, width) of the model's size: how far each pixel belongs to each slot, the background last,
 * adding up to 1; NULL from a model that does not see objects. */
VKOPPLE_API const float* vkopple_seen_soft_masks(const vkopple_seen* seen, size_t* planes, int32_t* height,
                                                 int32_t* width);

#ifdef __cplusplus
}
#endif

#endif
