"""Warnings of the log in the window, also after it is gone."""

import logging

from PySide6.QtCore import QCoreApplication, QEvent, QObject

from vrut_lite.app.window.logged_warnings import LoggedWarnings


def test_a_window_that_is_deleted_without_closing_hears_no_more(qapp):
    """Its handler would raise in the module that warns, and count as that module's fault."""
    before, heard = list(logging.getLogger().handlers), []
    window = QObject()
    warnings = LoggedWarnings(window)
    warnings.logged.connect(heard.append)
    logging.getLogger("weather_sky.module").warning("first")
    qapp.processEvents()
    assert heard == ["first"]
    window.deleteLater()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    assert logging.getLogger().handlers == before
    logging.getLogger("weather_sky.module").warning("second")
    assert heard == ["first"]
