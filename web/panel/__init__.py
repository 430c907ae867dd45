"""The side panel: what each of its tabs is told. The page draws it (static/panel)."""
