#include "bake/symmetry/group.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace frm::bake {
namespace {

double difference(const Matrix3& a, const Matrix3& b) {
    double largest = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) largest = std::max(largest, std::fabs(a.row[i][j] - b.row[i][j]));
    return largest;
}

// The nearest orthogonal matrix, by Newton's method for the polar decomposition (Higham 1986).
Matrix3 orthogonal(Matrix3 m) {
    for (int step = 0; step < 8; ++step) {
        const double det = determinant(m);
        const Matrix3 inverse_transposed{
            {cross(m.row[1], m.row[2]) / det, cross(m.row[2], m.row[0]) / det, cross(m.row[0], m.row[1]) / det}};
        m = (m + inverse_transposed) * 0.5;
    }
    return m;
}

// Signed permutations of the coordinate axes, which most bodies have, without the last digits of rounding.
Matrix3 tidied(Matrix3 m) {
    Matrix3 whole = m;
    for (Vec3d& row : whole.row)
        for (int j = 0; j < 3; ++j) row[j] = std::round(row[j]) + 0.0;
    return difference(whole, m) < 1e-9 ? whole : m;
}

bool close_under_multiplication(const std::vector<Matrix3>& generators, std::vector<Matrix3>& elements) {
    elements.assign(1, Matrix3{});
    for (std::size_t i = 0; i < elements.size(); ++i) {
        for (const Matrix3& g : generators) {
            const Matrix3 product = orthogonal(elements[i] * g);
            if (find_element(elements, product) < elements.size()) continue;
            if (elements.size() == kMostElements) return false;
            elements.push_back(product);
        }
    }
    return true;
}

using Table = std::vector<std::vector<std::size_t>>;

// table[i][j] is the product of elements i and j; false unless each row is a permutation.
bool multiply_out(const std::vector<Matrix3>& elements, Table& table) {
    table.clear();
    for (const Matrix3& a : elements) {
        std::vector<std::size_t> row;
        std::vector<char> met(elements.size(), 0);
        for (const Matrix3& b : elements) {
            const std::size_t product = find_element(elements, a * b);
            if (product == elements.size() || met[product]) return false;
            met[product] = 1;
            row.push_back(product);
        }
        table.push_back(std::move(row));
    }
    return true;
}

}  // namespace

std::size_t find_element(const std::vector<Matrix3>& elements, const Matrix3& g) {
    std::size_t nearest = elements.size();
    double least = kSameElement;
    for (std::size_t i = 0; i < elements.size(); ++i) {
        const double d = difference(elements[i], g);
        if (d < least) {
            least = d;
            nearest = i;
        }
    }
    return nearest;
}

std::vector<Matrix3> span_group(const std::vector<Matrix3>& generators) {
    std::vector<Matrix3> elements;
    Table table;
    if (!close_under_multiplication(generators, elements) || !multiply_out(elements, table)) return {};

    // Nearly a group: each element becomes the mean of what the others say it is, g = (g h) h^T, which makes errors
    // quadratically smaller (Grove, Karcher and Ruh 1974).
    for (int step = 0; step < 6; ++step) {
        std::vector<Matrix3> better;
        for (std::size_t g = 0; g < elements.size(); ++g) {
            Matrix3 sum = Matrix3{} * 0.0;
            for (std::size_t h = 0; h < elements.size(); ++h)
                sum = sum + elements[table[g][h]] * transpose(elements[h]);
            better.push_back(orthogonal(sum * (1.0 / static_cast<double>(elements.size()))));
        }
        elements = std::move(better);
    }

    // By rounded numbers, so that the order does not hang on the last digit.
    using Key = std::array<double, 11>;
    const auto key = [](const Matrix3& m) {
        Key k{};
        k[0] = determinant(m) > 0 ? 0 : 1;
        k[1] = -std::round((m.row[0].x + m.row[1].y + m.row[2].z) * 1e6);
        for (std::size_t i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) k[2 + 3 * i + static_cast<std::size_t>(j)] = -std::round(m.row[i][j] * 1e6);
        return k;
    };
    for (Matrix3& m : elements) m = tidied(m);
    std::stable_sort(elements.begin(), elements.end(),
                     [&](const Matrix3& a, const Matrix3& b) { return key(a) < key(b); });
    elements.front() = Matrix3{};
    return elements;
}

}  // namespace frm::bake
