// Eigenvalues and eigenvectors of a symmetric matrix of 4 x 4 by Jacobi's rotations, to float32's precision relative to the largest
// one. On return a's diagonal holds the values, the columns of v (v[row][column]) the vectors.
void eigen4(inout float a[4][4], out float v[4][4]) {
  for (uint i = 0; i < 4; ++i)
    for (uint j = 0; j < 4; ++j) v[i][j] = i == j ? 1.0 : 0.0;
  const uint kSweeps = 8;  // convergence is quadratic: 5 or 6 leave nothing off the diagonal
  for (uint sweep = 0; sweep < kSweeps; ++sweep)
    for (uint i = 0; i < 3; ++i)
      for (uint j = i + 1; j < 4; ++j) {
        if (a[i][j] == 0.0) continue;
        // t = tan of the angle that makes a[i][j] zero, the smaller of both.
        float theta = 0.5 * (a[j][j] - a[i][i]) / a[i][j];
        float t = abs(theta) > 1e18 ? 0.0 : (theta < 0.0 ? -1.0 : 1.0) / (abs(theta) + sqrt(theta * theta + 1.0));
        float c = 1.0 / sqrt(t * t + 1.0);
        float s = t * c;
        for (uint k = 0; k < 4; ++k) {
          float x = a[k][i], y = a[k][j];
          a[k][i] = c * x - s * y;
          a[k][j] = s * x + c * y;
        }
        for (uint k = 0; k < 4; ++k) {
          float x = a[i][k], y = a[j][k];
          a[i][k] = c * x - s * y;
          a[j][k] = s * x + c * y;
        }
        a[i][j] = 0.0;
        a[j][i] = 0.0;
        for (uint k = 0; k < 4; ++k) {
          float x = v[k][i], y = v[k][j];
          v[k][i] = c * x - s * y;
          v[k][j] = s * x + c * y;
        }
      }
}
