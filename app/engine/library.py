"""The worlds that can be opened by name: those of the program, of the user's folder and of this session."""

from __future__ import annotations

from dataclasses import replace

from sim2d import World, load_world, own_worlds, world_names


class Library:
    """Worlds and their titles, by name. A world whose file was deleted stays as long as it is open."""

    def __init__(self, world: World) -> None:
        self._worlds = {world.name: world}  # of this session; the others are read when they are opened
        self._filed = {world.name: world}  # as last read from their files or written there
        self._deleted: set[str] = set()
        self._titles = dict(world_names()) | dict(own_worlds.names())
        self._titles.setdefault(world.name, world.title)

    @property
    def titles(self) -> tuple[tuple[str, str], ...]:
        return tuple(self._titles.items())

    def world(self, name: str) -> World:
        """The world of this name. ValueError if there is none, or if its file is not valid."""
        if name not in self._titles:  # its file may have come since
            self._titles = dict(own_worlds.names()) | self._titles
        if name not in self._titles:
            known = ", ".join(self._titles)
            raise ValueError(f"unknown world {name!r}; expected one of: {known}")
        world = self._worlds.get(name)
        if world is None:
            world = self._filed[name] = load_world(name)
        return world

    def read(self, world: World) -> World:
        """Take in a world just read from its file. Returns this session's version of it, if there is one."""
        if world.name not in self._worlds:
            self._filed[world.name] = world
            self._titles.setdefault(world.name, world.title)
        return self._worlds.get(world.name, world)

    def filed(self, name: str) -> World | None:
        """The world as it was last read from its file or written to it."""
        return self._filed.get(name)

    def saved(self, world: World) -> None:
        """The world has been written to its file."""
        self._filed[world.name] = world
        self.add(world)

    def named(self, world: World) -> World:
        """The same world under a name that no other world has: plan, plan-2, plan-3."""
        if self._worlds.get(world.name) == world:
            return self._worlds[world.name]
        name, k = world.name, 2
        while name in self._titles:
            name, k = f"{world.name[:36]}-{k}", k + 1
        return replace(world, name=name)

    def add(self, world: World) -> None:
        self._worlds[world.name] = world
        self.restored(world.name, world.title)

    def restored(self, name: str, title: str) -> None:
        """The world's file exists, perhaps again."""
        self._deleted.discard(name)
        self._titles[name] = title

    def deleted(self, name: str, open_now: str) -> None:
        """The world's file has been deleted."""
        self._deleted.add(name)
        self.close(open_now)

    def close(self, open_now: str) -> None:
        """Forget every world whose file was deleted, except the one that is open now."""
        for name in self._deleted - {open_now}:
            self._titles.pop(name, None)
            self._worlds.pop(name, None)
        self._deleted &= {open_now}
