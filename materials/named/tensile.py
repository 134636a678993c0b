"""Rubbers whose coefficients are fitted here, to tests that others have published; MPa and kg/m³.

`bench/rubbers.py` fits all of them again and says what has changed.
"""

from __future__ import annotations

from materials.named.entry import Fitted, Rubber, Source, Way

DATABASE = Source(
    "fitted to tests of Marechal et al. 2021, Soft Robotics 8(3), first loading",
    "10.1089/soro.2019.0115",
    "ODbL 1.0, contents DbCL 1.0",
)
_TENSION = (
    "tension by ASTM D412 to failure, 450 mm/min, strain from the crosshead; not sheared, not "
    "pressed"
)
_DIGITISED = "https://github.com/Chongran-Zhao/Hyperelastic-fitting"


def _tension(
    name: str,
    product: str,
    file: str,
    law: str,
    coefficients: dict[str, float],
    rms: float,
    stretch: float = 3.0,
    density: float | None = None,
    density_source: str = "",
) -> Rubber:
    """A rubber of the database of soft robotics.

    Args:
        name: in a case.
        product: what it is, and who makes it.
        file: its test there; those in materials/data have hyphens and small letters.
        law: a law with the number of its terms.
        coefficients: of the law.
        rms: of the fit, over the greatest stress.
        stretch: up to which it is fitted: 3 or 2, whichever is missed by less.
        density: kg/m³.
        density_source: who gives it.
    """
    return Rubber(
        name=name,
        product=product,
        source=DATABASE,
        tested=_TENSION,
        density=density,
        density_source=density_source,
        law=law.rpartition("-")[0] if law[-1].isdigit() else law,
        coefficients=coefficients,
        stretches=(1.0, stretch),
        fitted=Fitted((("uniaxial", file),), law, stretch, rms),
    )


def _classic(
    name: str,
    product: str,
    paper: str,
    stem: str,
    law: str,
    coefficients: dict[str, float],
    rms: float,
    stretches: tuple[float, float],
) -> Rubber:
    """A rubber that was stretched in three ways.

    Args:
        name: in a case.
        product: what it is.
        paper: who measured it.
        stem: of the names of its tests in materials/data.
        law: a law with the number of its terms.
        coefficients: of the law.
        rms: of the fit, over the greatest stress of each way.
        stretches: least and greatest stretch.
    """
    ways: tuple[Way, ...] = ("uniaxial", "pure-shear", "equibiaxial")
    return Rubber(
        name=name,
        product=product,
        source=Source(f"fitted to digitised tests of {paper}", _DIGITISED, "MIT"),
        tested="uniaxial, pure shear and equibiaxial",
        law=law.rpartition("-")[0] if law[-1].isdigit() else law,
        coefficients=coefficients,
        stretches=stretches,
        fitted=Fitted(tuple((way, f"{stem}-{way}.csv") for way in ways), law, stretches[1], rms),
    )


TENSILE = (
    _tension(
        "body-double-silk",
        "Body Double Silk, Smooth-On",
        "BodyDouble SILK.csv",
        "yeoh-2",
        {"c1": 0.06731, "c2": 0.0002645},
        0.016,
    ),
    _tension(
        "dragon-skin-10",
        "Dragon Skin 10, Smooth-On",
        "Dragon Skin 10 MEDIUM.csv",
        "yeoh-2",
        {"c1": 0.02185, "c2": 0.002753},
        0.01,
        stretch=2.0,
        density=1070.0,
        density_source="arXiv 2201.12560",
    ),
    _tension(
        "dragon-skin-20",
        "Dragon Skin 20, Smooth-On",
        "Dragon Skin 20.csv",
        "yeoh-2",
        {"c1": 0.06117, "c2": 0.007956},
        0.013,
        stretch=2.0,
    ),
    _tension(
        "dragon-skin-30",
        "Dragon Skin 30, Smooth-On",
        "Dragon Skin 30.csv",
        "yeoh-2",
        {"c1": 0.0904, "c2": 0.0091},
        0.0067,
        stretch=2.0,
        density=1080.0,
        density_source="Smooth-On data sheet",
    ),
    _tension(
        "dragon-skin-fx-pro",
        "Dragon Skin FX-Pro, Smooth-On",
        "Dragon Skin FX Pro.csv",
        "yeoh-2",
        {"c1": 0.01528, "c2": 0.0005977},
        0.0087,
    ),
    _tension(
        "dragon-skin-fx-pro-slacker",
        "Dragon Skin FX-Pro with Slacker, Smooth-On",
        "Dragon Skin FX Pro Slacker.csv",
        "yeoh-2",
        {"c1": 0.001333, "c2": 8.447e-06},
        0.021,
    ),
    _tension(
        "ecoflex-0010",
        "Ecoflex 00-10, Smooth-On",
        "Ecoflex 00-10.csv",
        "yeoh-2",
        {"c1": 0.003669, "c2": 0.0001264},
        0.0098,
    ),
    _tension(
        "ecoflex-0030-tensile",
        "Ecoflex 00-30, Smooth-On",
        "Ecoflex 00-30.csv",
        "yeoh-2",
        {"c1": 0.007859, "c2": 9.427e-05},
        0.0083,
        density=1070.0,
        density_source="Smooth-On data sheet",
    ),
    _tension(
        "ecoflex-0035-fast",
        "Ecoflex 00-35 Fast, Smooth-On",
        "Ecoflex 00-35 FAST.csv",
        "yeoh-2",
        {"c1": 0.01359, "c2": 0.0005148},
        0.0055,
    ),
    _tension(
        "ecoflex-0050",
        "Ecoflex 00-50, Smooth-On",
        "Ecoflex 00-50.csv",
        "yeoh-2",
        {"c1": 0.01074, "c2": 0.0002308},
        0.0081,
    ),
    _tension(
        "mold-star-16-fast",
        "Mold Star 16 Fast, Smooth-On",
        "Mold Star 16 FAST.csv",
        "yeoh-2",
        {"c1": 0.04121, "c2": 0.002988},
        0.0046,
        stretch=2.0,
    ),
    _tension(
        "mold-star-20t",
        "Mold Star 20T, Smooth-On",
        "Mold Star 20T.csv",
        "yeoh-2",
        {"c1": 0.05642, "c2": 0.002954},
        0.0064,
    ),
    _tension(
        "platsil-gel-10",
        "PlatSil Gel-10, Polytek",
        "PlatSil Gel 10.csv",
        "yeoh-2",
        {"c1": 0.0271, "c2": 0.003802},
        0.008,
        stretch=2.0,
    ),
    _tension(
        "psycho-paint",
        "Psycho Paint, Smooth-On",
        "Psycho Paint.csv",
        "yeoh-2",
        {"c1": 0.06114, "c2": 0.002679},
        0.0061,
    ),
    _tension(
        "rebound-25",
        "Rebound 25, Smooth-On",
        "Rebound 25.csv",
        "yeoh-2",
        {"c1": 0.04869, "c2": 0.004435},
        0.0047,
        stretch=2.0,
    ),
    _tension(
        "rtv615",
        "RTV615, Momentive",
        "RTV615.csv",
        "yeoh",
        {"c1": 0.1636, "c2": 0.01366, "c3": 0.0009626},
        0.0017,
        stretch=2.91,
    ),
    _tension(
        "soloplast-150318",
        "Soloplast 150318, Soloplast-Vosschemie",
        "SOLOPLAST 150318.csv",
        "yeoh-2",
        {"c1": 0.03514, "c2": 0.001408},
        0.0089,
    ),
    _tension(
        "sorta-clear-40",
        "Sorta-Clear 40, Smooth-On",
        "SortaClear 40.csv",
        "yeoh-2",
        {"c1": 0.1389, "c2": 0.005546},
        0.002,
        stretch=2.0,
    ),
    _tension(
        "wagnersil-20-nf",
        "Wagnersil 20 NF",
        "WAGNERSIL 20 NF.csv",
        "yeoh-2",
        {"c1": 0.05574, "c2": 0.009027},
        0.0093,
        stretch=2.0,
    ),
    _classic(
        "natural-rubber-treloar",
        "vulcanised rubber, Treloar",
        "Treloar 1944, Trans. Faraday Soc. 40",
        "treloar-1944",
        "ogden",
        {
            "mu1": 0.004414,
            "alpha1": -2.356,
            "mu2": 0.3766,
            "alpha2": 1.742,
            "mu3": 7.133e-05,
            "alpha3": 7.008,
        },
        0.015,
        (1, 7.6),
    ),
    _classic(
        "isoprene-rubber-kawabata",
        "isoprene rubber, Kawabata",
        "Kawabata et al. 1981, Macromolecules 14",
        "kawabata-1981",
        "ogden-2",
        {"mu1": 0.02245, "alpha1": -1.394, "mu2": 0.365, "alpha2": 1.704},
        0.011,
        (1, 3.7),
    ),
    _classic(
        "silicone-meunier",
        "unfilled silicone rubber, Meunier",
        "Meunier et al. 2008, Polymer Testing 27",
        "meunier-2008",
        "ogden",
        {
            "mu1": 0.006459,
            "alpha1": 8.007,
            "mu2": 0.3408,
            "alpha2": 0.964,
            "mu3": 0.000538,
            "alpha3": -5.92,
        },
        0.015,
        (0.49, 2.17),
    ),
)
