/* Factorisation L D L' of a sparse symmetric matrix by dense fronts, and solves with it.

   A front holds own unknowns, those of positive sign first, and its border: later unknowns that
   its own are coupled to. Its tables, and what is included, are in tables.c. */

typedef struct {
  void (*gemm)(const char*, const char*, const int*, const int*, const int*, const double*, const double*, const int*, const double*, const int*, const double*, double*, const int*);
  void (*syrk)(const char*, const char*, const int*, const int*, const double*, const double*, const int*, const double*, double*, const int*);
  void (*trsm)(const char*, const char*, const char*, const char*, const int*, const int*, const double*, const double*, const int*, double*, const int*);
  void (*gemv)(const char*, const int*, const int*, const double*, const double*, const int*, const double*, const int*, const double*, double*, const int*);
  void (*trsv)(const char*, const char*, const char*, const int*, const double*, const int*, double*, const int*);
  void (*sytrf)(const char*, const int*, double*, const int*, int*, double*, const int*, int*);
  void (*syconv)(const char*, const char*, const int*, double*, const int*, const int*, double*, int*);
} blas_t;
enum { NB = 24, KEPT = 64 };
/* Columns that are factorised, and kept, together. L is kept by such blocks of columns, each with
   the rows from its first one on. */

static void bind(blas_t *z, const uintptr_t *address) { memcpy(z, address, sizeof(blas_t)); }

static const double one = 1.0, zero = 0.0, minus = -1.0;

static void add_runs(const plan_t *p, int f, double *panel, double *schur, double *schurs, int late)
{
  const int m = p->size[f], k = p->own[f], c = m - k;
  for (int64_t i = p->child_at[f]; i < p->child_at[f + 1]; i++) {
    const int g = p->child[i], n = p->size[g] - p->own[g];
    const double *s = schurs + p->schur[g];
    const int32_t *runs = p->run + 3 * p->run_at[i];
    const int count = p->run_at[i + 1] - p->run_at[i];
    for (int b = 0; b < count; b++) {
      const int from = runs[3*b], to = runs[3*b+1], len = runs[3*b+2];
      if ((to >= k) != late) continue;
      double *base = late ? schur - k - (int64_t)k * c : panel;
      const int64_t ld = late ? c : m;
      for (int j = 0; j < len; j++) {
        const double *sj = s + (int64_t)(from + j) * n;
        double *tj = base + (to + j) * ld;
        for (int i = j; i < len; i++) tj[to + i] += sj[from + i];
        for (int a = b + 1; a < count; a++) {
          const double *x = sj + runs[3*a]; double *y = tj + runs[3*a+1]; const int l = runs[3*a+2];
          for (int i = 0; i < l; i++) y[i] += x[i];
        }
      }
    }
  }
}

static void update(const blas_t *z, double *P, int m, int a, int b, int j, int k, double s, double *C, int *begun)
{ /* columns j..k and C lose s L L' of columns a..b */
  const int n = b - a, w = k - j, c = m - k;
  if (!n) return;
  const double alpha = -s, beta = *begun ? 1.0 : 0.0;
  const double *L = P + (int64_t)a * m;
  if (w) {
    z->syrk("L", "N", &w, &n, &alpha, L + j, &m, &one, P + j + (int64_t)j * m, &m);
    if (c) z->gemm("N", "T", &c, &w, &n, &alpha, L + k, &m, L + j, &m, &one, P + k + (int64_t)j * m, &m);
  }
  if (c) z->syrk("L", "N", &c, &n, &alpha, L + k, &m, &beta, C, &c);
  *begun = 1;
}

static int block(const blas_t *z, double *P, int m, int j, int nb, double s, double small, double *W)
{ /* columns j..j+nb of all rows; 0 where a pivot has the other sign */
  double kept[NB * NB], T[NB * NB], top = 0, low = INFINITY;
  double *D = P + j + (int64_t)j * m;
  const int rows = m - j - nb;
  for (int q = 0; q < nb; q++) for (int i = q; i < nb; i++) kept[i + q * nb] = D[i + (int64_t)q * m];
  /* T = lower Cholesky factor */
  for (int q = 0; q < nb; q++) {
    for (int i = 0; i < q; i++) T[i + q * nb] = 0;
    for (int i = q; i < nb; i++) T[i + q * nb] = s * kept[i + q * nb];
  }
  for (int q = 0; q < nb; q++) {
    double *c = T + q * nb;
    const double pivot = c[q];
    if (pivot > top) top = pivot;
    if (pivot < low) low = pivot;
    if (!(pivot > small * top) || !isfinite(pivot)) return 0;
    const double root = sqrt(pivot), inv = 1 / root;
    c[q] = root;
    for (int i = q + 1; i < nb; i++) c[i] *= inv;
    for (int t = q + 1; t < nb; t++) {
      const double l = c[t]; double *y = T + t * nb;
      for (int i = t; i < nb; i++) y[i] -= l * c[i];
    }
  }
  for (int q = 0; q < nb; q++) for (int i = q; i < nb; i++) D[i + (int64_t)q * m] = T[i + q * nb];
  if (!rows) return 1;
  /* inverse, column by column, in kept */
  for (int q = 0; q < nb; q++) {
    double *x = kept + q * nb;
    for (int i = 0; i < nb; i++) x[i] = i == q;
    for (int t = q; t < nb; t++) {
      const double v = x[t] /= T[t + t * nb];
      const double *c = T + t * nb;
      for (int i = t + 1; i < nb; i++) x[i] -= v * c[i];
    }
  }
  double *below = D + nb;
  z->gemm("N", "T", &rows, &nb, &nb, &s, below, &m, kept, &nb, &zero, W, &rows);
  for (int q = 0; q < nb; q++) memcpy(below + (int64_t)q * m, W + (int64_t)q * rows, sizeof(double) * rows);
  return 1;
}

static int signed_cholesky(const blas_t *z, double *P, int m, int a, int b, double s, double small, double *work)
{
  const int n = b - a;
  if (n <= NB) return n == 0 || block(z, P, m, a, n, s, small, work) ? b : a;
  const int half = a + (n / 2 + NB - 1) / NB * NB, w = b - half, rest = m - b;
  const int done = signed_cholesky(z, P, m, a, half, s, small, work), got = done - a;
  const double alpha = -s, *L = P + (int64_t)a * m;
  if (got) {
    double *N = P + half + (int64_t)half * m;
    z->syrk("L", "N", &w, &got, &alpha, L + half, &m, &one, N, &m);
    if (rest) z->gemm("N", "T", &rest, &w, &got, &alpha, L + b, &m, L + half, &m, &one, N + w, &m);
  }
  if (done < half) return done;
  return signed_cholesky(z, P, m, half, b, s, small, work);
}

static int pivoted(const blas_t *z, double *P, int m, int j, int k, double *C, int *begun, double *work, int32_t *perm, double *d, double *e, int *negative)
{ /* Bunch-Kaufman on own unknowns j..k */
  const int r = k - j, c = m - k, size = r * NB;
  int pivots[r], info;
  double *D = P + j + (int64_t)j * m;
  z->sytrf("L", &r, D, &m, pivots, work, &size, &info);
  if (info) return 1;
  z->syconv("L", "C", &r, D, &m, pivots, e + j, &info);
  int q[r];
  for (int i = 0; i < r; i++) q[i] = i;
  for (int i = 0; i < r;) {
    int a = i, b;
    if (pivots[i] > 0) { b = pivots[i] - 1; i++; }
    else { a = i + 1; b = -pivots[i + 1] - 1; i += 2; }
    int t = q[a]; q[a] = q[b]; q[b] = t;
  }
  for (int i = 0; i < r; i++) {
    perm[j + i] = j + q[i];
    d[j + i] = D[i + (int64_t)i * m];
    if (!isfinite(d[j + i])) return 1;
    D[i + (int64_t)i * m] = 1.0;
  }
  for (int i = 0; i < r;) {
    if (pivots[i] > 0) { if (d[j+i] == 0) return 1; e[j+i] = 0; *negative += d[j+i] < 0; i++; }
    else {
      double det = d[j+i] * d[j+i+1] - e[j+i] * e[j+i];
      if (det == 0) return 1;
      *negative += det < 0 ? 1 : 2 * (d[j+i] < 0); e[j+i+1] = 0; i += 2;
    }
  }
  /* rows of the columns before, columns of the rows below */
  for (int col = 0; col < j; col++) {
    double *x = P + j + (int64_t)col * m;
    for (int i = 0; i < r; i++) work[i] = x[q[i]];
    memcpy(x, work, sizeof(double) * r);
  }
  if (!c) return 0;
  double *W = work;
  for (int i = 0; i < r; i++) memcpy(W + (int64_t)i * c, P + k + (int64_t)(j + q[i]) * m, sizeof(double) * c);
  z->trsm("R", "L", "T", "U", &c, &r, &one, D, &m, W, &c);
  double *L = P + k + (int64_t)j * m;
  for (int i = 0; i < r;) {
    if (e[j+i] == 0) {
      for (int t = 0; t < c; t++) L[t + (int64_t)i * m] = W[t + (int64_t)i * c] / d[j+i];
      i++;
    } else {
      const double a = d[j+i], b = e[j+i], g = d[j+i+1], det = a * g - b * b;
      const double *u = W + (int64_t)i * c, *v = u + c;
      double *x = L + (int64_t)i * m, *y = x + m;
      for (int t = 0; t < c; t++) { x[t] = (g * u[t] - b * v[t]) / det; y[t] = (a * v[t] - b * u[t]) / det; }
      i += 2;
    }
  }
  const double beta = *begun ? 1.0 : 0.0;
  z->gemm("N", "T", &c, &c, &r, &minus, L, &m, W, &c, &beta, C, &c);
  *begun = 1;
  return 0;
}

static int factorise(const blas_t *z, const plan_t *p, int from, int to, const double *values, double *panels, double *schurs, double *hot, double *work, int32_t *perm, double *d, double *e, double small, int *negative, int *turned)
{
  for (int f = from; f < to; f++) {
    const int m = p->size[f], k = p->own[f], k1 = p->positive[f], c = m - k;
    double *S = panels + p->panel[f], *P = hot, *C = schurs + p->schur[f];
    for (int q = 0; q < k; q++) memset(P + q + (int64_t)q * m, 0, sizeof(double) * (m - q));
    for (int64_t i = p->entry_at[f]; i < p->entry_at[f + 1]; i++) P[p->target[i]] += values[p->source[i]];
    add_runs(p, f, P, C, schurs, 0);
    int32_t *pf = perm + p->first[f]; double *df = d + p->first[f], *ef = e + p->first[f];
    for (int i = 0; i < k; i++) { pf[i] = i; df[i] = i < k1 ? 1.0 : -1.0; ef[i] = 0; }
    int begun = 0;
    int done = signed_cholesky(z, P, m, 0, k1, 1.0, small, work);
    update(z, P, m, 0, done, k1, k, 1.0, C, &begun);
    if (done == k1) {
      done = signed_cholesky(z, P, m, k1, k, -1.0, small, work);
      update(z, P, m, k1, done, k, k, -1.0, C, &begun);
      *negative += done - k1;
    }
    if (done < k) {
      *turned += 1;
      if (pivoted(z, P, m, done, k, C, &begun, work, pf, df, ef, negative)) return f + 1;
    }
    for (int j = 0; j < k; j += KEPT) {
      const int w = k - j < KEPT ? k - j : KEPT, n = m - j;
      for (int q = 0; q < w; q++) memcpy(S + q + (int64_t)q * n, P + j + q + (int64_t)(j + q) * m, sizeof(double) * (n - q));
      S += (int64_t)w * n;
    }
    if (c) add_runs(p, f, P, C, schurs, 1);
  }
  return 0;
}

static void forward(const blas_t *z, const plan_t *p, int from, int to, const double *panels, const int32_t *perm, const double *d, const double *e, double *x, int64_t n, int columns, double *work)
{
  const int inc = 1;
  for (int f = from; f < to; f++) {
    const int m = p->size[f], k = p->own[f];
    const double *L = panels + p->panel[f];
    const int32_t *border = p->border + p->border_at[f], *pf = perm + p->first[f];
    const double *df = d + p->first[f], *ef = e + p->first[f];
    for (int r = 0; r < columns; r++) {
      const double *xr = x + r * n;
      double *v = work + (int64_t)r * m;
      for (int i = 0; i < k; i++) v[i] = xr[p->first[f] + pf[i]];
      for (int i = k; i < m; i++) v[i] = 0;
    }
    for (int j = 0; j < k; j += KEPT) {
      const int w = k - j < KEPT ? k - j : KEPT, h = m - j, rest = h - w;
      double *v = work + j;
      if (columns == 1) {
        z->trsv("L", "N", "N", &w, L, &h, v, &inc);
        if (rest) z->gemv("N", &rest, &w, &minus, L + w, &h, v, &inc, &one, v + w, &inc);
      } else {
        z->trsm("L", "L", "N", "N", &w, &columns, &one, L, &h, v, &m);
        if (rest) z->gemm("N", "N", &rest, &columns, &w, &minus, L + w, &h, v, &m, &one, v + w, &m);
      }
      L += (int64_t)w * h;
    }
    for (int r = 0; r < columns; r++) {
      double *xr = x + r * n, *v = work + (int64_t)r * m;
      for (int i = k; i < m; i++) xr[border[i - k]] += v[i];
      for (int i = 0; i < k;) {
        if (ef[i] == 0) { v[i] /= df[i]; i++; }
        else {
          const double a = df[i], b = ef[i], g = df[i+1], det = a * g - b * b, u = v[i], t = v[i+1];
          v[i] = (g * u - b * t) / det; v[i+1] = (a * t - b * u) / det; i += 2;
        }
      }
      memcpy(xr + p->first[f], v, sizeof(double) * k);
    }
  }
}

static void backward(const blas_t *z, const plan_t *p, int from, int to, const double *panels, const int32_t *perm, double *x, int64_t n, int columns, double *work)
{
  const int inc = 1;
  for (int f = to - 1; f >= from; f--) {
    const int m = p->size[f], k = p->own[f];
    const int32_t *border = p->border + p->border_at[f], *pf = perm + p->first[f];
    for (int r = 0; r < columns; r++) {
      const double *xr = x + r * n;
      double *v = work + (int64_t)r * m;
      memcpy(v, xr + p->first[f], sizeof(double) * k);
      for (int i = k; i < m; i++) v[i] = xr[border[i - k]];
    }
    const double *L = panels + p->panel[f];
    for (int j = 0; j < k; j += KEPT) L += (int64_t)(k - j < KEPT ? k - j : KEPT) * (m - j);
    for (int j = (k - 1) / KEPT * KEPT; j >= 0; j -= KEPT) {
      const int w = k - j < KEPT ? k - j : KEPT, h = m - j, rest = h - w;
      double *v = work + j;
      L -= (int64_t)w * h;
      if (columns == 1) {
        if (rest) z->gemv("T", &rest, &w, &minus, L + w, &h, v + w, &inc, &one, v, &inc);
        z->trsv("L", "T", "N", &w, L, &h, v, &inc);
      } else {
        if (rest) z->gemm("T", "N", &w, &columns, &rest, &minus, L + w, &h, v + w, &m, &one, v, &m);
        z->trsm("L", "L", "T", "N", &w, &columns, &one, L, &h, v, &m);
      }
    }
    for (int r = 0; r < columns; r++) {
      double *xr = x + r * n + p->first[f], *v = work + (int64_t)r * m;
      for (int i = 0; i < k; i++) xr[pf[i]] = v[i];
    }
  }
}
