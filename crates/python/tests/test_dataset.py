"""Data sets through Python."""

import pytest

import reality_sim


def test_pictures_fit_their_labels_and_are_not_made_again(database, tmp_path):
    out = tmp_path / "pictures"
    made = reality_sim.dataset(database, out, count=3, seed=5, balls="1", robots="1..2", format="png", depth=True)
    assert (made.pictures, made.written, made.skipped) == (3, 3, 0)
    coco = made.coco()
    assert len(coco["images"]) == 3 and len(coco["annotations"]) == made.annotations
    sizes = {(image["width"], image["height"]) for image in coco["images"]}
    assert sizes == {(database.lens.width, database.lens.height)}
    balls = [one for one in coco["annotations"] if one["category_id"] == 1]
    assert balls, "there is a ball in each picture, and most are seen"
    more = reality_sim.dataset(database, out, count=4, seed=5, balls="1", robots="1..2", format="png", depth=True)
    assert (more.pictures, more.written, more.skipped) == (4, 1, 3)


def test_other_settings_and_other_folders_are_refused(database, tmp_path):
    out = tmp_path / "pictures"
    reality_sim.dataset(database, out, count=1)
    before = sorted(out.rglob("*"))
    with pytest.raises(reality_sim.Error, match="seed"):
        reality_sim.dataset(database, out, count=1, seed=1)
    with pytest.raises(ValueError, match="cout"):
        reality_sim.dataset(database, out, cout=1)
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(reality_sim.Error, match="other files"):
        reality_sim.dataset(database, tmp_path, count=1)
    assert sorted(out.rglob("*")) == before
