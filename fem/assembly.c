/* Element matrices added straight into the values of a symmetric sparse matrix.

   Dofs are local: those that this rank owns come before its ghosts. The upper triangle is kept in
   two parts, each in compressed rows with rising columns: columns that this rank owns (inner), and
   those of ghosts (outer).

   What is put before this text says what FFCx's kernels are: tabulate, and NO_DATA. All functions
   are static: one of another library by the same name would be called instead. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  uintptr_t kernel;      /* of the element matrix, FFCx's tabulate_tensor */
  int32_t count;         /* cells or facets */
  int32_t stride;        /* coefficients of each */
  const int32_t *cell;   /* rising */
  const int32_t *facet;  /* number within the cell */
  const double *values;  /* coefficients, count × stride */
} integral;

typedef struct {
  int32_t count, width;    /* blocks, and dofs of each */
  const int32_t *dofs;     /* rising within a block */
  const int16_t *order;    /* of these dofs within the block's own matrix */
  const uint16_t *offset;  /* of each entry of the upper triangle within its row, row by row */
} blocks;

typedef struct {
  int32_t owned;           /* columns below are inner, others outer */
  const int32_t *inner, *outer; /* where rows start */
  double *values, *beyond; /* entries of the two parts */
  const uint8_t *free;     /* which dofs no constraint fixes */
} storage;

static int rising(const void *a, const void *b) {
  return (*(const int32_t *)a > *(const int32_t *)b) - (*(const int32_t *)a < *(const int32_t *)b);
}

/* Columns of each row in [low, high), at least the row itself where that is among them.

   start: of each dof within slots, the places block × width + position where it stands.
   mark: scratch, as many as dofs, −1. With columns 0 only the rows' starts are found. */
static void pattern(int32_t rows, int32_t low, int32_t high, const int32_t *start,
                    const int32_t *slots, const int32_t *dofs, int32_t width, int32_t *mark,
                    int32_t *begin, int32_t *columns) {
  int32_t end = 0;
  for (int32_t row = 0; row < rows; row++) {
    begin[row] = end;
    if (row >= low && row < high) {
      mark[row] = row;
      if (columns) columns[end] = row;
      end++;
    }
    for (int32_t s = start[row]; s < start[row + 1]; s++) {
      int32_t at = slots[s] % width, past = slots[s] - at + width;
      for (int32_t k = slots[s]; k < past; k++) {
        int32_t column = dofs[k];
        if (column < low || column >= high || mark[column] == row) continue;
        mark[column] = row;
        if (columns) columns[end] = column;
        end++;
      }
    }
    if (columns) qsort(columns + begin[row], end - begin[row], sizeof(int32_t), rising);
  }
  begin[rows] = end;
}

/* Offsets of entries with columns in [low, high) within their rows; 1 where one has no place, 2
   where a row is too long.

   place: scratch, as many as dofs, −1. */
static int offsets(int32_t rows, int32_t low, int32_t high, const int32_t *start,
                   const int32_t *slots, const int32_t *dofs, int32_t width, const int32_t *begin,
                   const int32_t *columns, int32_t *place, uint16_t *offset) {
  int64_t entries = (int64_t)width * (width + 1) / 2;
  for (int32_t row = 0; row < rows; row++) {
    int32_t from = begin[row], to = begin[row + 1];
    if (to - from > UINT16_MAX) return 2;
    for (int32_t k = from; k < to; k++) place[columns[k]] = k - from;
    for (int32_t s = start[row]; s < start[row + 1]; s++) {
      int32_t a = slots[s] % width;
      const int32_t *dof = dofs + (slots[s] - a);
      uint16_t *to_fill = offset + slots[s] / width * entries + a * width - a * (a + 1) / 2;
      for (int32_t b = a; b < width; b++) {
        if (dof[b] < low || dof[b] >= high) continue;
        if (place[dof[b]] < 0) return 1;
        to_fill[b] = place[dof[b]];
      }
    }
    for (int32_t k = from; k < to; k++) place[columns[k]] = -1;
  }
  return 0;
}

/* An entry of a symmetric block of which only the upper triangle is filled. */
static inline double entry(const double *block, int32_t width, int32_t i, int32_t j) {
  return i < j ? block[(int64_t)i * width + j] : block[(int64_t)j * width + i];
}

/* One row of a block, positions b of [first, last); a dof may stand twice in a block of tied
   ends, and then both of its entries beside the diagonal belong on it. */
static inline void add_row(const double *restrict block, int32_t width, int32_t a, int32_t first,
                           int32_t last, const int32_t *restrict dof,
                           const int16_t *restrict order, const uint16_t *restrict offset,
                           const uint8_t *free, double *restrict row) {
  int32_t i = order[a];
  if (free) {
    for (int32_t b = first; b < last; b++)
      if (free[dof[b]]) row[offset[b]] += entry(block, width, i, order[b]);
  } else {
    for (int32_t b = first; b < last; b++) row[offset[b]] += entry(block, width, i, order[b]);
  }
  for (int32_t b = a + 1; b < last && dof[b] == dof[a]; b++)
    if (b >= first) row[offset[b]] += entry(block, width, i, order[b]);
}

static void add_block(const double *block, const blocks *map, int64_t number, const storage *to) {
  int32_t width = map->width, inside = width;
  const int32_t *dof = map->dofs + number * width;
  const int16_t *order = map->order + number * width;
  const uint16_t *offset = map->offset + number * ((int64_t)width * (width + 1) / 2);
  while (inside > 0 && dof[inside - 1] >= to->owned) inside--;
  const uint8_t *some = NULL;
  for (int32_t a = 0; a < width; a++)
    if (!to->free[dof[a]]) some = to->free;
  for (int32_t a = 0; a < width; offset += width - a, a++) {
    if (!to->free[dof[a]]) continue;
    if (a < inside)
      add_row(block, width, a, a, inside, dof, order, offset - a, some,
              to->values + to->inner[dof[a]]);
    if (inside < width)
      add_row(block, width, a, a > inside ? a : inside, width, dof, order, offset - a, some,
              to->beyond + to->outer[dof[a]]);
  }
}

/* Add dense symmetric blocks, width × width; what belongs to one block of the map is summed first.

   last: for each block of the map, one more than the number of its last values; 1: no room. */
static int add_blocks(const double *values, const int32_t *last, const blocks *map,
                      const storage *to) {
  int64_t size = (int64_t)map->width * map->width, from = 0;
  double *sum = malloc((size + 1) * sizeof(double));
  if (!sum) return 1;
  for (int32_t number = 0; number < map->count; number++) {
    memset(sum, 0, size * sizeof(double));
    for (; from < last[number]; from++)
      for (int64_t k = 0; k < size; k++) sum[k] += values[from * size + k];
    add_block(sum, map, number, to);
  }
  free(sum);
  return 0;
}

/* Add the element matrices of a form; what a cell and its facets give is summed first.

   points: coordinates, three each; corners: of each cell, its points, nodes of them; 1: no room. */
static int add_cells(int32_t count, const integral *integrals, const double *constants,
                     const double *points, const int32_t *corners, int32_t nodes,
                     const blocks *map, const storage *to) {
  size_t size = (size_t)map->width * map->width;
  double *block = malloc((size + 3 * (size_t)nodes) * sizeof(double));
  int32_t *at = calloc(count + 1, sizeof(int32_t));
  if (!block || !at) {
    free(block);
    free(at);
    return 1;
  }
  double *place = block + size;
  const uint8_t unpermuted[2] = {0, 0};
  for (int32_t cell = 0; cell < map->count; cell++) {
    int found = 0;
    for (int32_t i = 0; i < count; i++) {
      const integral *part = integrals + i;
      for (; at[i] < part->count && part->cell[at[i]] == cell; at[i]++) {
        if (!found) {
          memset(block, 0, size * sizeof(double));
          for (int32_t k = 0; k < nodes; k++)
            memcpy(place + 3 * k, points + 3 * (int64_t)corners[(int64_t)cell * nodes + k],
                   3 * sizeof(double));
        }
        found = 1;
        ((tabulate *)part->kernel)(block, part->values + (int64_t)at[i] * part->stride, constants,
                                   place, part->facet + at[i], unpermuted NO_DATA);
      }
    }
    if (found) add_block(block, map, cell, to);
  }
  free(block);
  free(at);
  return 0;
}
