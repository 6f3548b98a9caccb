# The page that describes the interface for programs; what is in it is English in every language.

api-title = API per i programmi
api-about = Questa pagina elenca le richieste che i programmi possono inviare, e le risposte. Per i generatori di client:
api-subjects = Argomenti
api-shapes = Tipi di dati
api-for = Consentito a
api-name = Nome
api-body = Corpo
api-answer = Risposta
api-problems = Che cosa può andare storto
