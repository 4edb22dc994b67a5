"""Bad arguments are refused with plenoflame.Error and one sentence, wherever they are given."""

import numpy
from package import PackageTest, main

import plenoflame


class Arguments(PackageTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        test = cls("scene")
        cls.small = test.scene(40)
        cls.field = cls.small.render(samples=2)

    def refused(self, sentence, action, *arguments, **named):
        with self.assertRaises(plenoflame.Error) as caught:
            action(*arguments, **named)
        text = str(caught.exception)
        self.assertIn(sentence, text)
        self.assertNotIn("\n", text)

    def test_render(self):
        render = self.small.render
        self.refused("samples takes a whole number from 0 to 2147483647, not -1", render, -1)
        self.refused("samples takes a whole number from 0 to 2147483647, not 2.5", render, 2.5)
        self.refused("samples", render, "4")
        self.refused("samples", render, 1 << 31)
        self.refused("seed takes a whole number", render, 1, seed=-2)
        self.refused("there is no estimator 'sideways'", render, 1, estimator="sideways")
        self.refused("window takes four whole numbers x, y, width, height, not (1, 2, 3)", render, 1, window=(1, 2, 3))
        self.refused("window takes", render, 1, window=(1, 2, 3, 4.5))
        self.refused("window reaches beyond the sensor", render, 1, window=(30, 30, 20, 20))
        self.refused("target_error", render, 1, target_error=-0.1)
        self.refused("target_error", render, 1, target_error=float("nan"))
        self.refused("time_limit takes a number of at least 0, not -3", render, 1, time_limit=-3)
        self.refused("threads takes a whole number from 0 to 4096, not -1", render, 1, threads=-1)

    def test_rays(self):
        rays = self.small.rays
        self.refused("pixels takes pairs of whole numbers, column and row, not (1, 2, 3)", rays, pixels=[(1, 2, 3)])
        self.refused("pixels takes", rays, pixels=[5])
        self.refused("points takes points x, y, z in metres", rays, points=[(1, 2)])
        self.refused("points takes a number, not nan", rays, points=[(1, 2, float("nan"))])
        self.refused("random takes a whole number", rays, random=-1)
        self.refused("rays takes a whole number from 2", rays, random=1, rays=1)
        self.refused("there is no status 'lost'", rays, random=1, status="lost")
        self.refused("must end in .vtp", rays(pixels=[(20, 20)], rays=2).save, "rays.png")

    def test_light_fields(self):
        field = self.field
        self.refused("grid takes a whole number from 1 to 99, not 0", field.views, 0)
        self.refused("spread takes a number from 0 to 1, not 2", field.views, 3, spread=2)
        self.refused("there is no resampling 'bicubic'", field.views, 3, resampling="bicubic")
        self.refused("'x.png' must end in .exr; develop() makes a picture of it", field.save, "x.png")
        self.refused("not the name of a file", field.save, 3)
        self.refused("bits takes a whole number from 1 to 16, not 99", field.develop, bits=99)
        self.refused("saturation takes a number of at least 0, not -1", field.develop, saturation=-1)
        self.refused("there is no curve 'wavy'", field.develop, curve="wavy")
        self.refused("depth takes a number, not 'far'", field.refocus, "far")
        self.refused("aperture", field.refocus, 1, aperture=0)
        self.refused("depths takes", field.focus_stack, 3)
        self.refused("there is no format 'pdf'", field.export, self.folder / "e", "pdf")
        self.refused("holds no views", field.export, self.folder / "e", "libpleno", grid=3)
        self.assertFalse((self.folder / "e").exists())
        self.refused("reference takes a LightField", field.compare, 3)
        self.refused("row takes a whole number", field.views(3).epipolar, row=1000)
        self.refused("either a row or a column", field.views(3).epipolar)

    def test_flames(self):
        hot = numpy.full((4, 5, 6), 1500.0)
        make = plenoflame.flame_from_arrays
        self.refused("three axes of at least 2 samples", make,
                     hot, hot[0, :4], spacing=1e-3)
        self.refused("absorption has the shape (4, 5, 5), the temperature (4, 5, 6); they must be equal", make, hot,
                     hot[:, :, 1:], spacing=1e-3)
        self.refused("spacing takes lengths above 0", make, hot, hot, spacing=0)
        self.refused("spacing takes one length or three", make, hot, hot, spacing=(1, 2))
        self.refused("temperature is no array of numbers", make, [["hot"]], hot, spacing=1)
        self.refused("there is no flame 'match'", plenoflame.make_flame, "match")
        self.refused("height: ", plenoflame.make_flame, "candle", height=3)
        scene = self.small.copy()
        self.refused("flame takes a Flame", scene.add_flame, hot)
        cold = hot.copy()
        cold[1, 2, 3] = numpy.nan
        self.refused("at (1, 2, 3); values must be finite and not negative", scene.add_flame,
                     make(cold, hot, spacing=1e-3))
        with self.assertRaisesRegex(TypeError, "has no argument 'colour'"):
            scene.add_flame(make(hot, hot, spacing=1e-3), colour="red")
        self.assertEqual(scene.text, self.small.text)

    def test_scenes(self):
        scene = self.small.copy()

        def put(value):
            scene["render.samples"] = value
        self.refused("a scene takes texts, numbers, true or false", put, None)
        self.refused("position takes a whole number", scene.insert, "flames", "end")
        self.refused("resolution takes a whole number from 2 to 1024, not 1", scene.flame, 1)


if __name__ == "__main__":
    main()
