"""Python's lock is free while something is computed: another thread works, and the order of events shows it."""

import sys
import threading

from package import PackageTest, main, needs_vtk

import plenoflame


class Threads(PackageTest):
    def setUp(self):
        super().setUp()
        # Python takes the lock from a thread of its own accord after this time only: whoever holds it through a call
        # into the library keeps all others out, and is never asked.
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000)
        self.addCleanup(sys.setswitchinterval, interval)

    def ticks_during(self, action):
        """How many ticks another thread makes while `action` runs. It waits for nothing but Python's lock."""
        begun, ended = threading.Event(), threading.Event()
        ticks = []

        def tick():
            begun.wait()
            while not ended.is_set():
                ticks.append(1)
                threading.Event().wait(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        begun.set()
        try:
            action()
        finally:
            inside = len(ticks)
            ended.set()
            thread.join()
        return inside

    def test_render(self):
        scene = self.scene(120)
        self.assertGreater(self.ticks_during(lambda: scene.render(samples=64)), 0)

    def test_refocus(self):
        field = self.scene(200).render(samples=2)
        # Copies of numpy release the lock, too, but once each.
        self.assertGreater(self.ticks_during(lambda: field.refocus(1.0)), 5)

    def test_rays(self):
        scene = self.scene(200)
        self.assertGreater(self.ticks_during(lambda: scene.rays(random=200, rays=64, flame_samples=20)), 0)

    @needs_vtk
    def test_import(self):
        from fields import mesh
        from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(self.folder / "a.vtu"))
        writer.SetInputData(mesh())
        writer.Write()
        self.assertGreater(self.ticks_during(lambda: plenoflame.import_flame(self.folder / "a.vtu", constant=1, voxel_size=4e-4)), 50)

    def test_a_thread_meets_the_run_at_work(self):
        """A second thread waits until the run is at work, and the run until the thread has said so."""
        at_work, met = threading.Event(), threading.Event()
        thread = threading.Thread(target=lambda: (at_work.wait(60), met.set()))
        thread.start()

        def progress(_fraction):
            at_work.set()
            return met.is_set()

        field = self.scene().render(samples=1 << 30, time_limit=60, progress=progress)
        thread.join()
        self.assertTrue(met.is_set())
        self.assertFalse(field.complete)

    def test_one_scene_on_two_threads(self):
        scene = self.scene(40)
        expected = scene.render(samples=4, seed=2)
        results = [None] * 4

        def render(i):
            results[i] = scene.render(samples=4, seed=2)

        threads = [threading.Thread(target=render, args=(i,)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for field in results:
            self.assertTrue((field.flux == expected.flux).all())

    def test_one_light_field_on_two_threads(self):
        field = self.scene(60).render(samples=4)
        depths = [0.9, 1.0, 1.1, 1.2]
        expected = [field.refocus(depth).image for depth in depths]
        results = [None] * 4

        def refocus(i):
            results[i] = field.refocus(depths[i]).image

        threads = [threading.Thread(target=refocus, args=(i,)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for image, one in zip(results, expected):
            self.assertTrue((image == one).all())


if __name__ == "__main__":
    main()
