"""Numbers as a reader wants them: few digits, units, real minus signs."""
from __future__ import annotations

import math

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float, digits: int = 3) -> str:
    """Three significant digits, with a real minus sign, thin spaces and powers of ten."""
    if not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    if float(value).is_integer() and abs(value) < 1e7:
        return f"{int(value):,}".replace(",", "\u202f").replace("-", "−")
    if 1e-3 <= abs(value) < 1e6:
        text = f"{value:.{digits}g}"
        if "e" in text:
            return number(float(text))
        return text.replace("-", "−")
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    return f"{mantissa.replace('-', '−')} × 10{str(int(exponent)).translate(_SUPERSCRIPTS)}"


def quantity(value: float, unit: str) -> str:
    return f"{number(value)} {unit}" if unit else number(value)


def vector(values, unit: str = "") -> str:
    """Components with as many decimals as give the largest three significant digits; dust below 1e-9 is 0."""
    values = [float(value) if abs(value) >= 1e-9 else 0.0 for value in values]
    largest = max(map(abs, values))
    if not 1e-3 <= largest < 1e6:
        texts = [number(value) for value in values]
    else:
        decimals = max(0, 2 - math.floor(math.log10(largest)))
        texts = [f"{value:.{decimals}f}" for value in values]
        texts = [text.replace("-", "−") if float(text) else "0" for text in texts]
    return f"({', '.join(texts)})" + (f" {unit}" if unit else "")


def plural(count: int, word: str) -> str:
    return f"{number(count)} {word if count == 1 else 'bodies' if word == 'body' else word + 's'}"
