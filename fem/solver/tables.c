/* Tables of dense fronts: their borders, what goes where in them, and a residual.

   All numbers of unknowns are in the order of elimination. fronts.c follows in the same
   compilation. All functions are static: that of another library by the same name, such as bind of
   the C library, would be called instead. */

#include <math.h>
#include <stdint.h>
#include <string.h>

typedef struct {
  int fronts;
  const int32_t *positive, *own, *size; /* own unknowns of positive sign, all own, with border */
  const int64_t *panel, *schur;         /* where columns of L are, and what is left for the border */
  const int64_t *first;                 /* own unknown */
  const int64_t *border_at;
  const int32_t *border;                /* unknowns, rising */
  const int64_t *child_at;
  const int32_t *child;                 /* fronts */
  const int64_t *run_at;                /* by child */
  const int32_t *run;                   /* from place in the child's border, to place, length */
  const int64_t *entry_at;
  const int32_t *source, *target;       /* entries of the matrix, offsets in the front */
} plan_t;

/* Sums of the keys of each row's columns, by the upper triangle. */
static void sums(int32_t n, const int32_t *begin, const int32_t *columns, const uint64_t *key, uint64_t *sum)
{
  for (int32_t i = 0; i < n; i++)
    for (int32_t s = begin[i]; s < begin[i + 1]; s++) {
      const int32_t j = columns[s];
      sum[i] += key[j];
      if (j != i) sum[j] += key[i];
    }
}

/* Later vertices that each front is coupled to; 1 where they are more than `room`, 2 where a front
   is coupled to one that is neither before nor behind it. */
static int borders(int32_t fronts, const int32_t *own_at, const int32_t *own, const int64_t *child_at, const int32_t *child, const int32_t *graph_at, const int32_t *graph, const int32_t *front_of, const uint8_t *root, int32_t *mark, int64_t *out_at, int32_t *out, int64_t room)
{
  int64_t end = 0;
  for (int32_t f = 0; f < fronts; f++) {
    out_at[f] = end;
    for (int32_t i = own_at[f]; i < own_at[f + 1]; i++)
      for (int32_t s = graph_at[own[i]]; s < graph_at[own[i] + 1]; s++) {
        const int32_t v = graph[s];
        if (front_of[v] > f && mark[v] != f) { if (end == room) return 1; mark[v] = f; out[end++] = v; }
      }
    for (int64_t i = child_at[f]; i < child_at[f + 1]; i++)
      for (int64_t s = out_at[child[i]]; s < out_at[child[i] + 1]; s++) {
        const int32_t v = out[s];
        if (front_of[v] < f) return 2;
        if (front_of[v] > f && mark[v] != f) { if (end == room) return 1; mark[v] = f; out[end++] = v; }
      }
    if (root[f] && end > out_at[f]) return 2;
  }
  out_at[fronts] = end;
  return 0;
}

static void places(const plan_t *p, int f, int32_t *where)
{
  for (int i = 0; i < p->own[f]; i++) where[p->first[f] + i] = i;
  for (int64_t s = p->border_at[f]; s < p->border_at[f + 1]; s++) where[p->border[s]] = p->own[f] + s - p->border_at[f];
}

/* Where what children leave goes in their parents, as runs; returns their number. */
static int64_t runs(const plan_t *p, int32_t *where, int64_t *run_at, int32_t *run)
{
  int64_t end = 0;
  for (int f = 0; f < p->fronts; f++) {
    if (p->child_at[f] < p->child_at[f + 1]) places(p, f, where);
    for (int64_t i = p->child_at[f]; i < p->child_at[f + 1]; i++) {
      run_at[i] = end;
      const int g = p->child[i];
      const int32_t *b = p->border + p->border_at[g];
      const int n = p->border_at[g + 1] - p->border_at[g];
      for (int s = 0; s < n;) {
        int e = s + 1;
        const int to = where[b[s]];
        while (e < n && where[b[e]] == to + e - s && where[b[e]] != p->own[f]) e++;
        if (run) { run[3 * end] = s; run[3 * end + 1] = to; run[3 * end + 2] = e - s; }
        end++;
        s = e;
      }
    }
  }
  run_at[p->child_at[p->fronts]] = end;
  return end;
}

/* Which entries of the matrix go to each front, and where. */
static void entries(const plan_t *p, int32_t n, const int32_t *begin, const int32_t *columns, const int32_t *position, const int32_t *front_of, const uint8_t *mine, int32_t *high, int64_t *entry_at, int32_t *source, int32_t *target)
{
  const int F = p->fronts;
  memset(entry_at, 0, sizeof(int64_t) * (F + 2));
  for (int32_t i = 0; i < n; i++)
    for (int32_t s = begin[i]; s < begin[i + 1]; s++) {
      const int32_t a = position[i], b = position[columns[s]];
      const int f = front_of[a < b ? a : b];
      if (mine[f]) entry_at[f + 2]++;
    }
  for (int f = 0; f < F; f++) entry_at[f + 2] += entry_at[f + 1];
  for (int32_t i = 0; i < n; i++)
    for (int32_t s = begin[i]; s < begin[i + 1]; s++) {
      const int32_t a = position[i], b = position[columns[s]], low = a < b ? a : b;
      if (!mine[front_of[low]]) continue;
      const int64_t at = entry_at[front_of[low] + 1]++;
      source[at] = s;
      target[at] = low;
      high[at] = a < b ? b : a;
    }
}

static void locate(const plan_t *p, const int32_t *high, int32_t *where, int32_t *target)
{
  for (int f = 0; f < p->fronts; f++) {
    places(p, f, where);
    for (int64_t i = p->entry_at[f]; i < p->entry_at[f + 1]; i++)
      target[i] = where[high[i]] + (target[i] - p->first[f]) * p->size[f];
  }
}

/* r loses K x, and bound gains |K| |x|, by rows first, first + 1, ... of the upper triangle. */
static void residual(int32_t rows, int32_t first, const int32_t *begin, const int32_t *columns, const double *values, const double *x, double *r, double *bound)
{
  for (int32_t row = 0; row < rows; row++) {
    const int32_t i = first + row;
    double sum = 0, size = 0;
    for (int32_t s = begin[row]; s < begin[row + 1]; s++) {
      const int32_t j = columns[s];
      const double a = values[s], ax = a * x[i], ay = a * x[j];
      sum += ay;
      size += fabs(ay);
      if (j != i) { r[j] -= ax; bound[j] += fabs(ax); }
    }
    r[i] -= sum;
    bound[i] += size;
  }
}
