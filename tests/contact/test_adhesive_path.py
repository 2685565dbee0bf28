"""Loading paths with adhesion: jumps at the places of the closed forms, and the energy balance."""

from __future__ import annotations

import warnings
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from scipy.optimize import brentq

import contact
from contact import exact
from contact.studies.trace_kinds import drawn
from tests.tiers import quick

E, DELTA, WORK = 1.0, 0.01, 1e-5
WAVE = exact.JKRWave(DELTA, 1.0, E, WORK)
CYLINDER = exact.JKRCylinder(1.0, E, 1e-6, datum=1.0)
SCENES = {
    "wave": contact.Scene(
        contact.Sinusoid(DELTA, 1.0), E, contact.Periodic(), law=contact.JKR(WORK), load=0.0
    ),
    "cylinder": contact.Scene(
        contact.Parabola(1.0), E, contact.Isolated(datum=1.0), law=contact.JKR(1e-6), load=0.0
    ),
}
LOOPS = {
    "wave": {
        "load": [-2e-3, 4e-3, -2e-3],
        "approach": [-4e-3, 6e-3, -4e-3],
        "spring": [-0.05, 0.02, -0.05],
    },
    "cylinder": {
        "load": [-1e-3, 1e-3, -1e-3],
        "approach": [-1e-2, 1e-3, -1e-2],
        "spring": [-0.01, 1e-3, -0.01],
    },
}
STIFF = {"wave": 0.2, "cylinder": 0.05}
REFERENCES = {"wave": WAVE, "cylinder": CYLINDER}


@lru_cache
def loop(body, held):
    kwargs = {"stiffness": STIFF[body]} if held == "spring" else {"control": held}
    return contact.path(SCENES[body], LOOPS[body][held], **kwargs)


def value(state, held, stiffness):
    return {
        "load": state.load,
        "approach": state.approach,
        "spring": state.approach + state.load / stiffness,
    }[held]


def half_widths(body, held):
    """Three half widths of the contact, computed from the closed form.

    The first one is that at the minimum of the control, the second one that after the jump from
    first touch, and the third one that at the largest value of the control in the loop.
    """
    reference, stiffness = REFERENCES[body], STIFF[body]

    def of(a):
        return value(reference.at(a), held, stiffness)

    a = np.geomspace(1e-4, 0.45, 400) if body == "wave" else np.geomspace(1e-4, 0.3, 400)
    values = np.array([of(x) for x in a])
    low = int(np.argmin(values[:300]))

    def slope(x):
        return (of(x * (1 + 1e-5)) - of(x * (1 - 1e-5))) / (2e-5 * x)

    least = brentq(slope, a[low - 2], a[low + 2], xtol=1e-14)
    top = low + int(np.flatnonzero(values[low:] > LOOPS[body][held][1])[0])
    reach = [
        brentq(lambda x, v=v: of(x) - v, least, a[top], xtol=1e-15)
        for v in (0.0, LOOPS[body][held][1])
    ]
    return least, *reach


def work(reference, first, last):
    """int P d(approach) between two half widths: Gauss's rule for the integral by parts."""
    t, weights = np.polynomial.legendre.leggauss(40)
    a = 0.5 * (first + last) + 0.5 * (last - first) * t
    states, (start, end) = [reference.at(x) for x in a], (reference.at(first), reference.at(last))
    slopes = [reference._rates(x)[0] for x in a]
    by_parts = (
        0.5
        * (last - first)
        * sum(w * s * r.approach for w, s, r in zip(weights, slopes, states, strict=True))
    )
    return end.load * end.approach - start.load * start.approach - by_parts


@pytest.mark.parametrize("held", ["load", "approach", "spring"])
@pytest.mark.parametrize("body", ["wave", "cylinder"])
def test_a_loop_loses_the_work_of_its_load_by_the_closed_forms(body, held):
    reference, found = REFERENCES[body], loop(body, held)
    least, touched, top = half_widths(body, held)
    jump_in, pull_off = found.events
    assert (jump_in.kind, pull_off.kind) == ("jump-in", "pull-off")
    assert jump_in.value == 0.0 and pull_off.value == pytest.approx(
        value(reference.at(least), held, STIFF[body]), rel=1e-10
    )
    assert jump_in.after[0, 1] == pytest.approx(touched, rel=1e-9)
    assert pull_off.before[0, 1] == pytest.approx(least, rel=1e-6)
    # Work of the load over the loop: along the curve of equilibria, and along the straight
    # lines of the jumps. A load that is held does further work at pull-off, down to the
    # smallest approach at which a contact exists.
    on, off = reference.at(touched), reference.at(least)
    done = work(reference, touched, top) + work(reference, top, least) + 0.5 * on.load * on.approach
    if held == "spring":
        done += 0.5 * off.load * off.load / STIFF[body]
    if held == "load":
        done += off.load * (reference.pull_off(0.0).approach - off.approach)
    assert found.dissipated == pytest.approx(done, rel=1e-8)
    assert found.work == pytest.approx(done, rel=1e-8)
    assert jump_in.lost > 0.0 < pull_off.lost


@pytest.mark.parametrize("held", ["load", "approach", "spring"])
def test_every_point_of_a_loop_has_its_error_its_certificate_and_its_branch(held):
    found = loop("wave", held)
    below, top, again = found.solutions
    assert (
        below.load == again.load == 0.0 and below.contact_fraction == 0.0 and len(below.zones) == 0
    )
    assert below.energy.total == 0.0 and np.all(below.pressure([0.0, 0.3]) == 0.0)
    twice = contact.path(SCENES["cylinder"], [1e-3, 0.0, 0.0]).solutions
    assert [solution.branch for solution in twice] == ["advancing", "receding", "receding"]
    assert (top.branch, again.branch) == ("advancing", "receding") and "raised" in top.plan[
        "branch"
    ].detail
    assert top.error <= 1e-8 and top.certificate.holds and top.certificate.stability > 0.0
    least = value(WAVE.at(top.zones[0, 1]), held, STIFF["wave"])
    assert least == pytest.approx(LOOPS["wave"][held][1], rel=1e-9)
    pull_off = top.pull_off
    assert value(WAVE.at(pull_off.zones[0, 1]), held, STIFF["wave"]) == pytest.approx(
        found.events[-1].value, rel=1e-9
    )


SEPARATING = {
    "wave": (contact.Sinusoid(1e-6, 1e-4), contact.Periodic()),
    "parabola": (contact.Parabola(1e-3), contact.Isolated(datum=1e-2)),
    "two tips": (contact.Biquadratic(1e-3, 2e-4), contact.Isolated(datum=1e-2)),
    "punch": (contact.Flat(1e-4), contact.Isolated(datum=1e-2)),
}


@pytest.mark.parametrize("held", ["load", "approach"])
@pytest.mark.parametrize("law", [contact.JKR(0.05), contact.Dugdale(0.05, 1e6)], ids=["JKR", "D"])
@pytest.mark.parametrize("shape", SEPARATING)
def test_a_pull_off_is_placed_in_the_middle_of_a_zone(shape, law, held):
    profile, interaction = SEPARATING[shape]
    scene = contact.Scene(profile, 1e9, interaction, law=law, load=0.0)
    event = contact.path(scene, [0.0, -4e3 if held == "load" else -1e-4], control=held).events[-1]
    # On these symmetric profiles, the middle of all contact is x = 0, with or without a zone.
    middles = np.append(event.before.mean(axis=1), [0.0] if len(event.before) < 2 else [])
    assert event.kind == "pull-off"
    assert np.abs(middles - event.position).min() < 1e-7 * 1e-4


def test_a_drawn_path_of_few_values_goes_through_the_equilibria_between_them():
    pytest.importorskip("matplotlib")
    profile, interaction = SEPARATING["wave"]
    for law in (contact.JKR(0.05), contact.Dugdale(0.05, 1e6)):
        scene = contact.Scene(profile, 1e9, interaction, law=law, load=0.0)
        axes = contact.path(scene, [0.0, 2000.0]).plot().axes[0]
        line = max(axes.lines, key=lambda one: len(one.get_xdata()))
        near, load = line.get_xdata() * 1e-9, line.get_ydata() * 1e3  # drawn in nm and N/mm
        fine = contact.path(scene, np.linspace(0.0, 2000.0, 12)[1:])
        for solution in fine.solutions:
            away = np.hypot(
                (near - solution.approach) / np.ptp(near), (load - solution.load) / np.ptp(load)
            )
            assert away.min() < 0.01


def test_a_spring_pulls_off_between_a_held_approach_and_a_held_load():
    ends = [
        contact.path(SCENES["cylinder"], [0.0, -1.0], stiffness=k).events[-1] for k in (1e3, 1e-3)
    ]
    assert ends[0].approach == pytest.approx(CYLINDER.pull_off(0.0).approach, rel=1e-3)
    assert ends[1].load == pytest.approx(CYLINDER.pull_off_load, rel=1e-3)


def test_a_jump_into_full_contact_is_johnsons_and_full_contact_does_not_open_again():
    wave = exact.JKRWave(DELTA, 1.0, E, 3e-5)
    scene = contact.Scene(
        contact.Sinusoid(DELTA, 1.0), E, contact.Periodic(), law=contact.JKR(3e-5), load=0.0
    )
    found = contact.path(scene, [0.0, 0.03, -0.5])
    (event,) = found.events
    last = wave.jump_into_full_contact
    assert event.kind == "full" and event.value == pytest.approx(last.load, rel=1e-10)
    lost = last.energy - wave.full_contact_energy + last.load * (DELTA - last.approach)
    assert event.lost == pytest.approx(lost, rel=1e-8)
    assert [len(s.zones) for s in found.solutions] == [1, 0, 0] and found.solutions[
        -1
    ].contact_fraction == 1.0
    assert found.work == pytest.approx(
        found.solutions[-1].energy.total - found.solutions[0].energy.total + event.lost, rel=1e-12
    )
    # An open interval of half width c under the tension s has the intensity K = s sqrt(c/2).
    flaw = 2 * E * 3e-5 / np.pi / found.solutions[-1].certificate.smallest_pressure ** 2
    assert f"half width {flaw * 1e6:.3g} µm would open" in found.solutions[-1].certificate.note
    # The far end of the spring is at 0.05, and the approach of full contact is DELTA.
    sprung = contact.path(scene, [0.0, 0.05], stiffness=1.0)
    assert sprung.events[-1].kind == "full" and sprung.solutions[-1].load == pytest.approx(
        0.05 - DELTA, rel=1e-12
    )


LAYER = contact.Layer(1e-4, 0.3)
# At approaches above 1 um, the mean of the profile, the layer is compressed uniformly.
MODULUS = 1e9 * 1e-4 / (2 * LAYER.compression)
LAWS = [contact.JKR(1e-3), contact.Dugdale(1e-2, 1e6)]


def on_a_base(law):
    return contact.Scene(
        contact.Sinusoid(1e-6, 1e-4),
        1e9,
        contact.Periodic(),
        law=law,
        substrate=LAYER,
        approach=6e-6,
    )


@pytest.mark.parametrize("law", LAWS, ids=["JKR", "Dugdale"])
def test_on_a_layer_in_full_contact_the_approach_determines_the_load(law):
    scene, loads = on_a_base(law), [MODULUS * (approach - 1e-6) for approach in (6e-6, 5e-6)]
    for branch in ("advancing", "receding"):
        solved = contact.solve(scene, branch=branch)
        assert solved.contact_fraction == 1.0 and solved.load == pytest.approx(loads[0], rel=1e-12)
    closed = contact.path(scene, [6e-6, 5e-6], control="approach")
    assert [s.load for s in closed.solutions] == pytest.approx(
        loads, rel=1e-12
    ) and not closed.events
    assert closed.work == pytest.approx(-1e-6 * np.mean(loads), rel=1e-12)


@pytest.mark.parametrize("law", quick(LAWS, LAWS[:1]), ids=["JKR", "Dugdale"])
def test_on_a_layer_full_contact_stays_under_jkr_and_opens_at_one_load_under_dugdale(law):
    scene, lifted, load = on_a_base(law), 3e-6, MODULUS * 5e-6
    up = contact.path(scene, [-lifted, 6e-6, -lifted], control="approach")
    down = contact.path(scene, [-lifted, load, 0.0], control="load")
    kinds = {event.kind: event for event in up.events}
    if isinstance(law, contact.JKR):
        assert up.solutions[-1].contact_fraction == 1.0
        assert up.solutions[-1].load == pytest.approx(MODULUS * (-lifted - 1e-6), rel=1e-12)
    else:
        assert up.work == pytest.approx(up.dissipated, rel=1e-8)
        assert kinds["open"].load == pytest.approx(
            {e.kind: e for e in down.events}["open"].load, rel=1e-9
        )
    assert kinds["full"].value > 1e-6 / 2 and kinds["full"].load_after == pytest.approx(
        MODULUS * (kinds["full"].value - 1e-6), rel=1e-6
    )


def test_above_the_critical_work_the_wave_closes_as_it_touches():
    scene = contact.Scene(
        contact.Sinusoid(DELTA, 1.0),
        E,
        contact.Periodic(),
        law=contact.JKR(1.01 * WAVE.self_closing_work),
        load=0.0,
    )
    found = contact.path(scene, [-1e-3, 1e-3])
    assert [event.kind for event in found.events] == ["full"] and found.events[0].value == 0.0


def rough():
    rng = np.random.default_rng(0)
    k, phase = np.arange(1, 7), rng.uniform(0, 2 * np.pi, 6)
    size = 1e-7 / k
    profile = contact.Fourier(1e-4, size * np.cos(phase), size * np.sin(phase))
    return contact.Scene(profile, 1e9, contact.Periodic(), law=contact.JKR(1e-3), load=0.0)


@lru_cache
def rough_loop():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", contact.ModelWarning)
        return contact.path(rough(), [-100.0, 13.0, 40.0, 13.0, -100.0])


def test_a_rough_contact_is_wider_on_the_way_down_and_every_jump_loses_energy():
    found = rough_loop()
    kinds = [event.kind for event in found.events]
    assert kinds[0] == "jump-in" and kinds[-1] == "pull-off" and len(kinds) > 4
    assert all(event.lost > 0.0 for event in found.events)
    rising, falling = found.solutions[1], found.solutions[3]
    assert falling.zone_widths.sum() > 1.01 * rising.zone_widths.sum()
    assert falling.energy.total != pytest.approx(rising.energy.total, rel=1e-3)
    assert found.work == found.dissipated
    for event in found.events:
        before, after = np.diff(event.before).sum(), np.diff(event.after).sum()
        assert (after > before) == (event.kind in ("jump-in", "birth", "merge"))


def test_on_the_way_up_a_path_has_the_advancing_contacts():
    alone = contact.solve(
        contact.Scene(rough().profile, 1e9, contact.Periodic(), law=contact.JKR(1e-3), load=40.0)
    )
    assert rough_loop().solutions[2].zones == pytest.approx(
        alone.zones, abs=1e-8 * alone.zone_widths.min()
    )


@pytest.mark.parametrize("start", [1, 3])
def test_between_jumps_the_work_of_the_load_is_the_change_of_energy(start):
    found = rough_loop()
    first = found.solutions[start]
    last = 0.98 * first.load if start == 3 else 1.02 * first.load
    t, weights = np.polynomial.legendre.leggauss(6)
    loads = 0.5 * (first.load + last) + 0.5 * (last - first.load) * t
    values = np.concatenate(([13.0], [40.0, 13.0] if start == 3 else [], loads, [last]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", contact.ModelWarning)
        piece = contact.path(rough(), values)
    one, *inner, two = piece.solutions[-8:]
    assert one.zones == pytest.approx(first.zones, abs=1e-9 * first.zone_widths.min()) and len(
        one.zones
    ) == len(two.zones)
    by_parts = 0.5 * (last - first.load) * float(weights @ [s.approach for s in inner])
    done = two.load * two.approach - one.load * one.approach - by_parts
    assert two.energy.total - one.energy.total == pytest.approx(done, rel=1e-8)


def test_without_a_datum_jumps_are_found_but_no_energy_is_stated():
    pair = contact.Scene(
        contact.Biquadratic(1.0, 0.2), 1.0, contact.Isolated(), law=contact.JKR(1e-6), load=0.0
    )
    found = contact.path(pair, [0.0, 5e-3])
    assert [event.kind for event in found.events] == [
        "merge"
    ] and found.dissipated is None is found.work
    assert found.events[0].lost is None


def test_arguments_that_a_path_cannot_follow_are_refused_by_name():
    wave = SCENES["wave"]
    bare = contact.Scene(contact.Sinusoid(DELTA, 1.0), E, contact.Periodic(), load=1.0)
    wrong = (
        ({"control": "half_width"}, "control"),
        ({"stiffness": -1.0}, "stiffness"),
        ({"stiffness": 1.0, "control": "load"}, "stiffness"),
    )
    for kwargs, name in wrong:
        with pytest.raises(contact.SceneError, match=name):
            contact.path(wave, [0.0], **kwargs)
    with pytest.raises(contact.SceneError, match="values"):
        contact.path(wave, [])
    with pytest.raises(contact.OutOfRange, match="mean height of the profile"):
        contact.path(wave, [0.0, DELTA], control="approach")
    for kwargs in ({"control": "approach"}, {"stiffness": 1.0}):
        with pytest.raises(contact.SceneError, match="frictionless"):
            contact.path(bare, [1e-3], **kwargs)
    lone = contact.Scene(
        contact.Parabola(1.0), E, contact.Isolated(), law=contact.JKR(1e-6), load=0.0
    )
    with pytest.raises(contact.SceneError, match="approach"):
        contact.path(lone, [0.0], control="approach")


def test_the_figure_has_both_ways_every_jump_and_the_surfaces_at_pull_off():
    found = loop("wave", "load")
    figure = found.plot()
    curve, surfaces = figure.axes
    told = [text.get_text() for text in curve.get_legend().get_texts()]
    assert (
        told == ["rising", "falling", "jump-in", "pull-off"]
        and surfaces.get_title() == "just before pull-off"
    )
    rising, falling = (
        np.concatenate([line.get_ydata() for line in curve.lines if line.get_label() == name])
        for name in told[:2]
    )
    assert rising.max() == pytest.approx(4.0) and falling.min() == pytest.approx(
        1e3 * found.events[-1].load, rel=1e-9
    )
    x, surface, body = found.events[-1].surfaces
    a = found.events[-1].before[0, 1]
    touching, apart = np.abs(x) < a * (1 - 1e-9), np.abs(x) > a * (1 + 1e-9)
    assert np.all(body[touching] == surface[touching]) and np.all(body[apart] > surface[apart])
    assert found.plot(surfaces) is figure
    with pytest.raises(contact.SceneError, match="ax"):
        found.plot("axes")


@pytest.mark.parametrize("law", [contact.JKR(0.05), contact.Dugdale(0.05, 1e6)], ids=["JKR", "D"])
def test_a_path_along_which_the_surfaces_stay_apart_is_drawn_without_a_curve(law):
    profile, interaction = SEPARATING["wave"]
    scene = contact.Scene(profile, 1e9, interaction, law=law, load=0.0)
    for values in ([-100.0], [-100.0, -50.0]):
        assert contact.path(scene, values).plot().axes[0].get_xlabel() == "approach [m]"


def test_an_approach_of_zero_has_no_sign():
    scene = contact.Scene(
        *SEPARATING["parabola"][:1],
        1e9,
        contact.Isolated(datum=1e-2),
        approach=0.0,
        law=contact.JKR(0.05),
    )
    assert str(contact.solve(scene).approach) == "0.0"


def test_the_followed_states_lie_on_the_curve_of_equilibria():
    load, approach, width, _ = loop("wave", "spring").followed.T
    on = np.flatnonzero(width > 0.0)
    assert len(on) > 7
    for k in on:
        state = WAVE.at(0.5 * width[k])
        assert (load[k], approach[k]) == pytest.approx(
            (state.load, state.approach), rel=1e-8, abs=1e-11
        )


def test_separate_surfaces_are_drawn_over_a_period_and_refused_without_one():
    below = loop("wave", "approach").solutions[0]
    surfaces, pressure = below.plot().axes
    assert not any(
        np.isfinite(line.get_ydata()).any()
        for line in surfaces.get_lines()
        if line.get_label() == "contact"
    )
    assert pressure.get_ylim() == (0.0, pytest.approx(1.08))
    assert (
        below.gap([0.0, 0.5]) == pytest.approx([4e-3, 4e-3 + 2 * DELTA])
        and below.to_dict()["certificate"]["holds"]
    )
    with pytest.raises(contact.SceneError, match="apart"):
        loop("cylinder", "approach").solutions[0].plot()


def test_a_pull_off_whose_end_breaks_a_symmetry_is_located_and_its_loss_left_open():
    pair = contact.Scene(
        contact.Biquadratic(1.0, 0.2, period=1.0),
        1.0,
        contact.Periodic(),
        law=contact.JKR(6.33e-7),
        load=0.0,
    )
    found = contact.path(pair, [0.0, 1.8e-3, -0.05])
    assert [event.kind for event in found.events] == ["merge", "pull-off"] and found.events[
        0
    ].lost > 0.0
    assert found.events[1].lost is None is found.dissipated and found.events[1].load < 0.0


@pytest.mark.slow
def test_one_of_two_equal_tips_at_a_held_approach_comes_off_where_stability_is_lost():
    twice = contact.Scene(
        contact.Fourier(1.0, [0.0, -0.01], [0.0, 0.0]),
        1.0,
        contact.Periodic(),
        law=contact.JKR(1e-4),
        approach=0.0,
    )
    one = contact.path(twice, [0.006, -0.0041], control="approach")
    (event,) = one.events
    assert (
        event.kind == "death"
        and event.lost > 0.0
        and (len(event.before), len(event.after)) == (2, 1)
    )
    above, below = (
        contact.solve(replace(twice, approach=event.value + more)) for more in (1e-7, -1e-9)
    )
    assert len(above.zones) == 2 and 0.0 < above.certificate.stability < 1e-3
    assert (
        len(below.zones) == 1
        and below.certificate.holds
        and below.load == pytest.approx(event.load_after, rel=1e-5)
    )


@pytest.mark.slow
def test_two_equal_tips_on_a_soft_spring_come_off_together_since_one_alone_would_have_before():
    twice = contact.Scene(
        contact.Fourier(1.0, [0.0, -0.01], [0.0, 0.0]),
        1.0,
        contact.Periodic(),
        law=contact.JKR(1e-4),
        approach=0.0,
    )
    kinds, far = [], {}
    for stiffness in (1.0, 3.0):
        found = contact.path(
            twice,
            [0.006 + 0.02 / stiffness, -0.0041 - 0.05 / stiffness],
            control="approach",
            stiffness=stiffness,
        )
        kinds.append([(event.kind, len(event.before), len(event.after)) for event in found.events])
        far[stiffness] = found.events[0].value, found.events[-1]
    assert kinds == [[("pull-off", 2, 0)], [("death", 2, 1), ("pull-off", 1, 0)]]
    # The last tip comes off the stiffer spring at an approach and a load near which one tip alone
    # would also come off the softer spring. The far end of a spring is at approach +
    # load/stiffness. For the softer spring it is above the far end at which both tips come off.
    # For the stiffer spring it is below the far end at which the first tip comes off.
    one = far[3.0][1]
    assert (
        one.approach + one.load / 1.0 > far[1.0][0] and one.approach + one.load / 3.0 < far[3.0][0]
    )


def test_a_tip_that_others_relieve_as_they_touch_begins_later():
    # Four tips have nearly equal heights. The first tips in contact pull the surfaces so close
    # that all four tips would touch. But the others relieve one of these tips, so that it
    # touches only later.
    body = drawn(np.random.default_rng(4), "turned", 300)
    scene = contact.Scene(
        body, 2.3e11, contact.Periodic(), law=contact.JKR(0.08145729947206055), mean_pressure=1.0
    )
    loads = 1001345.1073676093 * np.array([-0.02, 0.5, -0.3])
    loop = contact.path(scene, loads, control="mean_pressure")
    assert [(event.kind, len(event.before), len(event.after)) for event in loop.events] == [
        ("jump-in", 0, 3),
        ("birth", 3, 4),
        ("pull-off", 4, 0),
    ]
    advancing = contact.solve(replace(scene, mean_pressure=float(loads[1])))
    assert loop.solutions[1].zones == pytest.approx(advancing.zones, abs=1e-9 * body.period)


@pytest.mark.slow
def test_an_end_past_its_equilibrium_is_not_put_back_for_ever():
    # A trace of steps with noise. An end between two steps moved past its equilibrium, to a
    # place from which it would run on, and was put back, three thousand times.
    rng = np.random.default_rng(21)
    body = drawn(rng, "steps", 200)
    scene = contact.Scene(
        body, 2.3e11, contact.Periodic(), law=contact.JKR(19.087977588936866), mean_pressure=1.0
    )
    loop = contact.path(
        scene, 4.375646328234528e8 * np.array([-0.02, 1.0]), control="mean_pressure"
    )
    assert loop.solutions[1].zones == pytest.approx(
        contact.solve(scene.under("mean_pressure", 4.375646328234528e8)).zones, rel=1e-8
    )
