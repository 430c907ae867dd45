from __future__ import annotations

import colorsys
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from ratslam_core import LocalView, LocalViewParams, Odometry, RatSlam, RatSlamParams
from ratslam_core.local_view.front_ends import named_front_end
from ratslam_core.local_view.front_ends.complex_cells import REACH, ComplexCells, gabor_pair
from ratslam_core.local_view.front_ends.hue_saturation import HueSaturation, histogram

Image = NDArray[np.uint8]
FRONT_ENDS = ("template", "complex cells", "hue and saturation", "scene numbers")
SEEING = FRONT_ENDS[:3]
P = LocalViewParams()


def office(seed: int, light: float = 1.0, turned: int = 0) -> Image:
    """A varied scene of coloured panels, (48, 64, 3), shifted by `turned` pixels to the left."""
    rng = np.random.default_rng(seed)
    scene = np.full((48, 100, 3), 120.0)
    for _ in range(40):
        x, y, w, h = rng.integers(0, 92), rng.integers(0, 40), rng.integers(4, 20), rng.integers(4, 16)
        scene[y : y + h, x : x + w] = rng.uniform(20, 160, 3)
    return np.rint(light * scene[:, 16 - turned : 80 - turned]).astype(np.uint8)


def grating(across_deg: float, phase: float, wavelength: float = 6.0) -> Image:
    """Stripes, (36, 48): 100 grey and 15 to either side; `across_deg` is the direction across them."""
    y, x = np.mgrid[0:36, 0:48]
    a = math.radians(across_deg)
    waves = np.cos(2 * math.pi / wavelength * (x * math.cos(a) + y * math.sin(a)) + phase)
    return np.rint(100 + 15 * waves).astype(np.uint8)


def view_of(kind: str, **params: Any) -> LocalView:
    return LocalView(LocalViewParams(front_end=kind, **params))


# ---------------------------------------------------------------- what all have in common


@pytest.mark.parametrize("kind", SEEING)
def test_scenes_are_recruited_and_known_again(kind: str) -> None:
    local_view = view_of(kind)
    for seed in range(6):
        assert local_view.observe(office(seed)).recruited
    for seed in range(6):
        seen = local_view.observe(office(seed))
        assert (seen.view, seen.recruited, seen.difference) == (seed, False, 0.0)
        assert (seen.facing_rad is None) == (kind == "hue and saturation")


@pytest.mark.parametrize("light", [0.6, 0.8, 1.3])
@pytest.mark.parametrize("kind", SEEING)
def test_light_changes_templates_and_nothing_else(kind: str, light: float) -> None:
    for seed in range(6):
        local_view = view_of(kind)
        local_view.observe(office(seed))
        assert (local_view.observe(office(seed, light)).view == 0) == (kind != "template")


@pytest.mark.parametrize("kind", ["template", "complex cells"])
def test_the_shift_tells_the_heading(kind: str) -> None:
    column = LocalViewParams().field_of_view / 12
    for columns in (-2, -1, 1, 2):
        read = []
        for seed in range(12):
            local_view = view_of(kind, match_threshold=60.0, edge_threshold=60.0)
            local_view.observe(office(seed))
            read.append(local_view.observe(office(seed, turned=round(columns * 64 / 12))).facing_rad)
        assert float(np.median(read)) == pytest.approx(columns * column, abs=0.2 * column)


@pytest.mark.parametrize("kind", SEEING)
def test_surprise_is_a_jump_that_no_turn_explains(kind: str) -> None:
    local_view = view_of(kind, surprise=10.0, edge_surprise=10.0, colour_surprise=10.0)
    surprised = []
    for turned in (0, 4, 8, 4):
        local_view.observe(office(3, turned=turned))
        surprised.append(local_view.image_change > 1)
    assert surprised == [False] * 4
    for seed in range(10, 20):
        for surprised_now in (True, False):
            local_view.observe(office(seed))
            assert (local_view.image_change > 1) is surprised_now


@pytest.mark.parametrize("kind", SEEING)
def test_a_bare_wall_shows_nothing(kind: str) -> None:
    rng = np.random.default_rng(0)
    wall = np.clip(rng.normal(128, 1, (48, 64, 3)), 0, 255).astype(np.uint8)
    local_view = view_of(kind)
    assert local_view.observe(wall).view == -1
    assert local_view.observe(office(0)).view == 0


@pytest.mark.parametrize("kind", FRONT_ENDS)
def test_features_are_96_bytes_with_a_picture_and_words(kind: str) -> None:
    end = named_front_end(LocalViewParams(front_end=kind))
    features = end.look(office(1), 4711)
    assert (features.shape, features.dtype) == ((96,), np.uint8)
    picture = end.picture(features)
    assert picture.dtype == np.uint8
    assert picture.shape[2:] == ((3,) if kind == "hue and saturation" else ())
    assert picture.max() > picture.min()
    assert len(end.words(features)) > 5


@pytest.mark.parametrize("kind", SEEING)
@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (np.zeros((48, 64, 3)), "image must be an array of uint8, got float64"),
        (np.full((48, 64, 3), math.nan, np.float32), "image must be an array of uint8, got float32"),
        (None, "image must be an array of uint8, got NoneType"),
        (np.zeros((48, 64, 4), np.uint8), r"image must have shape \(h, w\) or \(h, w, 3\), got \(48, 64, 4\)"),
        (np.zeros((7, 64, 3), np.uint8), r"image must be at least 8 x 12 pixels, got \(7, 64\)"),
    ],
)
def test_what_is_no_image_is_refused(kind: str, bad: Any, message: str) -> None:
    local_view = view_of(kind)
    with pytest.raises(ValueError, match=message):
        local_view.observe(bad)
    assert len(local_view) == 0


def test_the_front_end_is_fixed_until_a_reset() -> None:
    brain = RatSlam()
    changed = RatSlamParams(local_view=LocalViewParams(front_end="complex cells"))
    with pytest.raises(ValueError, match="front_end is fixed at 'template' until a reset, got 'complex cells'"):
        brain.set_params(changed)
    with pytest.raises(ValueError, match="front_end must be one of 'template', 'complex cells'"):
        LocalViewParams(front_end="eyes")


# ---------------------------------------------------------------- complex cells


def test_complex_cells_are_the_energy_of_quadrature_pairs_by_loops() -> None:
    """Convolution, energy, division by the brightness around and means of areas, pixel by pixel; borders are mirrored."""
    image = np.random.default_rng(1).integers(0, 256, (36, 48)).astype(np.uint8)
    grey = image.astype(np.float64)
    mirrored = np.pad(grey, REACH, mode="symmetric")
    half = P.edge_neighbourhood // 2
    expected = np.zeros((12, 2, 4))
    for k in range(4):
        even, odd = (f.astype(np.float64) for f in gabor_pair(math.pi * k / 4))
        for y in range(36):
            for x in range(48):
                patch = mirrored[y : y + 2 * REACH + 1, x : x + 2 * REACH + 1]
                inner = patch[REACH - half : REACH + half + 1, REACH - half : REACH + half + 1]
                energy = math.hypot((patch * even).sum(), (patch * odd).sum()) / (inner.mean() + P.edge_dark)
                expected[x // 4, y // 18, k] += energy / (4 * 18)
    got = ComplexCells(P).look(image).astype(float)
    assert np.abs(got - np.clip(P.edge_gain * expected.ravel(), 0, 255)).max() <= 0.51


@pytest.mark.parametrize("k", range(4))
def test_each_complex_cell_has_its_orientation_and_no_phase(k: int) -> None:
    wavelength = 6.0
    seen = np.array([ComplexCells(P).look(grating(45 * k, p, wavelength)) for p in np.arange(0, 2 * math.pi, 0.5)])
    energy = seen.reshape(len(seen), 12, 2, 4).astype(float)[:, 2:-2]  # away from the borders
    mine = energy[..., k]
    others = np.delete(energy, k, axis=-1)
    assert mine.min() > 4 * others.max()
    assert mine.std(axis=0).max() < 0.05 * mine.mean()


def test_gabor_pairs_are_blind_to_brightness() -> None:
    for k in range(4):
        even, odd = gabor_pair(math.pi * k / 4)
        assert abs(even.sum()) < 1e-6 > abs(odd.sum())
        assert (even**2).sum() == pytest.approx((odd**2).sum(), rel=1e-5)
    assert ComplexCells(P).look(np.full((36, 48), 200, np.uint8)).max() == 0


# ---------------------------------------------------------------- hue and saturation


def literal_histogram(hue: list[float], saturation: list[float]) -> NDArray[np.float64]:
    shares = np.zeros((12, 8))
    for h, s in zip(hue, saturation, strict=True):
        level = min(s / P.full_saturation, 1.0) * 7
        certain = min(s / P.certain_saturation, 1.0)
        for row in range(8):
            by_level = max(0.0, 1 - abs(level - row))
            for column in range(12):
                away = abs(math.remainder(h / 30 - column, 12))
                shares[column, row] += by_level * (certain * max(0.0, 1 - away) + (1 - certain) / 12)
    return shares / len(hue)


def test_the_histogram_is_that_of_the_loops() -> None:
    rng = np.random.default_rng(2)
    hue = np.concatenate([rng.uniform(0, 360, 200), [0, 30, 359.99, 360 - 1e-3]]).astype(np.float32)
    saturation = np.concatenate([rng.uniform(0, 1, 200), [0, 0.5, 1, 0.07]]).astype(np.float32)
    got = histogram(hue, saturation, P.full_saturation, P.certain_saturation)
    assert got == pytest.approx(literal_histogram(hue.tolist(), saturation.tolist()), abs=1e-5)
    assert got.sum() == pytest.approx(1.0, abs=1e-6)


def test_grey_has_no_hue() -> None:
    """A grey pixel that noise makes slightly red or green counts as the same grey; a red pixel is not a green one."""

    def apart(saturation: float) -> float:
        red, green = (
            histogram(np.float32([hue]), np.float32([saturation]), P.full_saturation, P.certain_saturation)
            for hue in (0, 120)
        )
        return float(np.abs(red - green).sum())

    assert apart(0.0) == 0.0
    assert apart(0.01) < 0.1 * apart(0.6)
    assert apart(0.6) == pytest.approx(2.0)  # nothing in common


@pytest.mark.parametrize("hue", [0.0, 0.2, 0.55, 0.99])
def test_the_picture_shows_the_hue_where_it_is(hue: float) -> None:
    rgb = np.rint(255 * np.array(colorsys.hsv_to_rgb(hue, 0.45, 0.8))).astype(np.uint8)
    end = HueSaturation(P)
    picture = end.picture(end.look(np.tile(rgb, (48, 64, 1)))).astype(int)
    row, column = np.unravel_index(int(picture.sum(2).argmax()), picture.shape[:2])
    assert abs(math.remainder(column - 12 * hue, 12)) <= 1
    assert row >= 5


def test_hues_need_colour() -> None:
    with pytest.raises(
        ValueError, match=r"image must be in colour, shape \(h, w, 3\), for hue and saturation, got \(48, 64\)"
    ):
        view_of("hue and saturation").observe(np.zeros((48, 64), np.uint8))


# ---------------------------------------------------------------- scene numbers


def test_every_number_is_one_cell() -> None:
    local_view = view_of("scene numbers")
    numbers = [0, 255, 256, 2**63 - 1, 7, np.int64(65536)]
    for view, scene in enumerate(numbers):
        seen = local_view.observe(None, scene)  # type: ignore[arg-type]
        assert (seen.view, seen.recruited) == (view, True)
    for view, scene in reversed(list(enumerate(numbers))):
        seen = local_view.observe(office(view), scene)  # type: ignore[arg-type]
        assert (seen.view, seen.recruited, seen.best_view, seen.facing_rad) == (view, False, view, None)
        assert local_view.image_change <= 1
    assert len(local_view) == len(numbers)
    assert local_view.front_end.words(local_view.stored(3)) == f"scene {2**63 - 1}"


@pytest.mark.parametrize("scene", [None, -1, 2**63, 1.0, True, "3", math.nan])
def test_what_is_no_scene_number_is_refused(scene: Any) -> None:
    brain = RatSlam(RatSlamParams(local_view=LocalViewParams(front_end="scene numbers")))
    before = brain.digest()
    with pytest.raises(ValueError, match=f"scene must be a whole number from 0 to {2**63 - 1} for scene numbers, got"):
        brain.step(None, Odometry(0.1, 0.0, 0.1), scene=scene)
    assert brain.digest() == before


# ---------------------------------------------------------------- N_vis


def numbers_seen(share: float, ticks: int, known: int = 20) -> tuple[LocalView, list[tuple[int, int, bool]]]:
    local_view = LocalView(LocalViewParams(front_end="scene numbers", false_positives=share), np.random.default_rng(3))
    seen = []
    for tick in range(ticks):
        one = local_view.observe(None, tick % known)
        seen.append((tick % known, one.view, one.false_positive))
        assert not (one.false_positive and (one.view == one.best_view or one.recruited or one.facing_rad is not None))
        assert one.recruited or one.best_view == tick % known
    return local_view, seen


@pytest.mark.parametrize("share", [0.0, 0.02, 0.1, 1.0])
def test_so_many_recognised_views_are_taken_for_another(share: float) -> None:
    local_view, seen = numbers_seen(share, 8020)
    wrong = [(right, view) for right, view, false in seen if false]
    assert all(false == (right != view) for right, view, false in seen)
    assert local_view.false_positives == len(wrong)
    expected = share * 8000
    assert abs(len(wrong) - expected) <= 4 * math.sqrt(expected * (1 - share))
    if share == 1.0:
        others = np.bincount([view for right, view in wrong if right == 4], minlength=20)
        assert others[4] == 0
        assert others[[k for k in range(20) if k != 4]].min() > 5  # any other one


def test_a_single_known_view_cannot_be_taken_for_another() -> None:
    local_view, seen = numbers_seen(1.0, 5, known=1)
    assert local_view.false_positives == 0
    assert {view for _, view, _ in seen} == {0}


def test_false_positives_draw_from_a_generator_of_their_own() -> None:
    """Another share does not change the run's own generator; the digest covers the draws."""
    brains = []
    for share in (0.0, 0.5):
        params = RatSlamParams(local_view=LocalViewParams(front_end="scene numbers", false_positives=share))
        brain = RatSlam(params, np.random.default_rng(9))
        for tick in range(50):
            brain.step(None, Odometry(0.1, 0.0, 0.1), scene=tick % 5)
        brains.append(brain)
    assert brains[0].rng.bit_generator.state == brains[1].rng.bit_generator.state
    assert brains[1].local_view.false_positives > 5
    before = brains[1].digest()
    brains[1].local_view.rng.random()
    assert brains[1].digest() != before
    assert replace(brains[1].params, local_view=brains[0].params.local_view) == brains[0].params


# ---------------------------------------------------------------- memory


def test_a_view_takes_no_more_than_150_bytes() -> None:
    local_view = view_of("scene numbers")
    for scene in range(4000):
        local_view.observe(None, scene)
        assert local_view.memory_bytes <= max(150 * (scene + 1), 1024 * 96)


@pytest.mark.parametrize(
    ("kind", "changed"),
    [
        ("complex cells", {"edge_neighbourhood": 3}),
        ("complex cells", {"edge_dark": 80.0}),
        ("complex cells", {"edge_gain": 60.0}),
        ("hue and saturation", {"full_saturation": 0.1}),
        ("hue and saturation", {"certain_saturation": 0.9}),
        ("hue and saturation", {"full_bin": 0.9}),
    ],
)
def test_each_parameter_changes_what_is_seen(kind: str, changed: dict[str, float]) -> None:
    plain, other = view_of(kind), view_of(kind, **changed)
    assert not np.array_equal(plain.front_end.look(office(1), None), other.front_end.look(office(1), None))


@pytest.mark.parametrize("kind", SEEING)
def test_with_the_gate_open_nothing_is_bland(kind: str) -> None:
    """A threshold of 0 is how the papers have it: even an image of one grey is a view."""
    off = {"min_contrast": 0.0, "min_edges": 0.0, "min_colour": 0.0}
    grey = np.full((36, 48, 3), 128, np.uint8)
    open_gate, gated = view_of(kind, **off), view_of(kind)
    assert open_gate.observe(grey).view == 0
    assert gated.observe(grey).view == -1


@pytest.mark.parametrize("scene", [0, 7, 1234567, 2**63 - 1])
def test_a_scene_number_is_drawn_whole(scene: int) -> None:
    """All around the digits there is paper."""
    end = named_front_end(LocalViewParams(front_end="scene numbers"))
    picture = end.picture(end.look(None, scene))
    assert picture.max() > 200
    for edge in (picture[0], picture[-1], picture[:, 0], picture[:, -1]):
        assert (edge == picture[0, 0]).all()
